"""How much rougher than the truth a motion is, measured by its second differences."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


def second_differences(X: Floats, frames: Sequence[int]) -> Floats:
    """Second differences x(t+1) − 2 x(t) + x(t−1), wherever three frames follow one another at equal steps.

    X       : (frame, joint, xyz) mesh unit
    frames  : (frame,) source frame numbers, ascending
    returns : (triple, joint, xyz) mesh unit
    """
    step = np.diff(np.asarray(frames))
    at = np.flatnonzero(step[1:] == step[:-1]) + 1
    difference: Floats = X[at + 1] - 2.0 * X[at] + X[at - 1]
    return difference


def jitter(X: Floats, Y: Floats, frames: Sequence[int]) -> tuple[float, float]:
    """Root mean square of the second differences of the error, and of the true motion (ours).

    X, Y    : (frame, joint, xyz) positions in the result and in the truth, of the same joints, mesh unit
    frames  : (frame,) source frame numbers, ascending
    returns : of x − y, and of y, mesh unit a frame²; both 0 where no three frames follow one another or there is no joint
    """
    error, true = second_differences(X - Y, frames), second_differences(Y, frames)
    if not error.size:
        return 0.0, 0.0
    return float(np.sqrt((error**2).sum(axis=2).mean())), float(np.sqrt((true**2).sum(axis=2).mean()))
