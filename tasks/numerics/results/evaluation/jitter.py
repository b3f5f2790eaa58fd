"""How much rougher than the truth a motion is, seen in its second differences."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def second_differences(X: Floats, frames: Sequence[int]) -> Floats:
    """(triple, joint, xyz) x(t+1) − 2 x(t) + x(t−1) wherever three frames follow one another at equal steps, mesh unit.

    X      : (frame, joint, xyz) mesh unit
    frames : (frame,) their numbers, ascending
    """
    step = np.diff(np.asarray(frames))
    at = np.flatnonzero(step[1:] == step[:-1]) + 1
    difference: Floats = X[at + 1] - 2.0 * X[at] + X[at - 1]
    return difference


def jitter(X: Floats, Y: Floats, frames: Sequence[int]) -> tuple[float, float]:
    """Root mean square of the second differences of what was found beyond the true ones, and of the true ones, mesh unit.

    X, Y    : (frame, joint, xyz) found and true positions of the same joints
    returns : (of x − y, of y); both 0 where no three frames follow one another or there is no joint
    """
    error, true = second_differences(X - Y, frames), second_differences(Y, frames)
    if not error.size:
        return 0.0, 0.0
    return float(np.sqrt((error**2).sum(axis=2).mean())), float(np.sqrt((true**2).sum(axis=2).mean()))
