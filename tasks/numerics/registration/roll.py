"""How limbs rolled about their own axis: one likely path through every limb's candidates of all frames (Viterbi 1967).

In one frame noise picks a roll, and neighbouring frames have other noise. Roll that tracking lost is zero in the reference,
changes slowly from frame to frame, and fits better in all these frames than no roll and than any other roll; on a round limb
other rolls fit as well. Measured, the mean of both differences: lost forearms 0.057 and more, round limbs 0.035 at most.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints


class RollSettings(NamedTuple):
    """When a path of roll is clear enough to be taken, and what changes of roll cost."""

    saved: float = 0.045
    """Misfit that a path must save where it rolls, against no roll and against all rolls elsewhere, mean of the two. Chosen
    between lost forearms (0.057 and more) and round limbs (0.035 at most)."""
    saved_each: float = 0.025
    """Misfit that it must save against each of the two. Chosen on the same limbs."""
    frames: int = 3
    """Frames in which the limb must roll clearly. Chosen on: not recorded."""
    elsewhere: float = float(np.radians(50.0))
    """Roll elsewhere is farther than this from the path, radians. Chosen on: not recorded."""
    clear: float = float(np.radians(20.0))
    """Roll that counts as clear, radians. Chosen on: not recorded."""
    least: float = float(np.radians(10.0))
    """Smaller roll, radians, is left as it is. Chosen on: not recorded."""
    change: float = float(np.radians(30.0))
    """Change of roll between two frames that costs `price`, radians. Chosen on: not recorded."""
    price: float = 0.05
    """Cost of that change, share of the usual misfit. Chosen on: not recorded."""


def chosen_rolls(
    angle: Floats, misfit: Floats, reference: int, settings: RollSettings | None = None, begins: Sequence[int] = ()
) -> Ints:
    """Which candidate every limb takes in every frame (ours).

    angle     : (frame, limb, candidate) roll from where the limb was, radians; of the first candidate nearly 0
    misfit    : (frame, limb, candidate) 0 to 1, see `roll_candidates`
    reference : position of the reference frame, in which no limb rolls
    begins    : positions of frames at which another take begins, where roll may change at no cost
    returns   : (frame, limb) candidates, −1 where the limb stays; a limb stays in all frames unless its path is clearly better
    """
    settings = settings or RollSettings()
    out = np.full(angle.shape[:2], -1, dtype=np.int64)
    for k in range(angle.shape[1]):
        path = _path(angle[:, k], misfit[:, k], reference, settings, begins)
        rows = np.arange(len(path))
        roll = np.where(rows == reference, 0.0, np.abs(angle[rows, k, path]))
        clear = roll > settings.clear
        if clear.sum() >= settings.frames and _is_clearly_better(angle[clear, k], misfit[clear, k], path[clear], settings):
            out[:, k] = np.where(roll > settings.least, path, -1)
    return out


def frame_rolls(angle: Floats, misfit: Floats, rolls: Flags, settings: RollSettings | None = None) -> Ints:
    """Which candidate every limb takes in one frame by itself, of limbs that are known to roll (ours).

    angle, misfit : (limb, candidate) as in `chosen_rolls`
    rolls         : (limb,) limbs that rolled clearly in other frames; of others noise would pick the roll
    returns       : (limb,) candidates, −1 where the limb stays
    """
    settings = settings or RollSettings()
    out = np.full(len(angle), -1, dtype=np.int64)
    for k in np.flatnonzero(rolls):
        best = misfit[k].argmin(keepdims=True)
        is_clear = abs(angle[k, best[0]]) > settings.clear
        if is_clear and _is_clearly_better(angle[k : k + 1], misfit[k : k + 1], best, settings):
            out[k] = best[0]
    return out


def _is_clearly_better(angle: Floats, misfit: Floats, path: Ints, settings: RollSettings) -> bool:
    """Whether a path fits better than no roll and than the best of all rolls elsewhere; a round limb fits as well there."""
    rows = np.arange(len(path))
    here = misfit[rows, path]
    apart = np.abs(np.angle(np.exp(1j * (angle - angle[rows, path][:, None]))))
    elsewhere = np.where(apart > settings.elsewhere, misfit, 1.0).min(axis=1)
    saved = (misfit[:, 0] - here).mean(), (elsewhere - here).mean()
    return bool(np.mean(saved) > settings.saved and min(saved) > settings.saved_each)


def _path(angle: Floats, misfit: Floats, reference: int, settings: RollSettings, begins: Sequence[int] = ()) -> Ints:
    """(frame,) candidates of least Σ misfit / usual + price · (change of roll / 30°)², the first one at the reference."""
    usual = max(float(np.median(misfit.min(axis=1))), np.finfo(float).tiny)
    cost = misfit / usual
    cost[reference, 1:] = np.inf
    total, back = cost[0], np.zeros(angle.shape, dtype=np.int64)
    for t in range(1, len(angle)):
        change = np.angle(np.exp(1j * (angle[t - 1][:, None] - angle[t])))
        price = 0.0 if t in begins else settings.price
        step = total[:, None] + price * (change / settings.change) ** 2
        back[t] = step.argmin(axis=0)
        total = step.min(axis=0) + cost[t]
    path = [int(total.argmin())]
    for t in range(len(angle) - 1, 0, -1):
        path.append(int(back[t, path[-1]]))
    return np.array(path[::-1])
