"""How limbs really turned about their own axis: of every frame's candidates, those that make one likely way (Viterbi 1967).

In one frame noise picks a turn, and neighbouring frames have other noise. A twist that tracking lost is none in the
reference, grows from frame to frame, and fits better all the while, than no turn and than any other: on a round limb,
whatever turn noise picks, another does as well. Measured, the mean of both: lost forearms 0.057 and more, round limbs 0.035
at most.
"""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

CLEARLY = 0.045  # misfit that a way must save where it turns, against no turn and against all turns elsewhere, the mean of both
EITHER = 0.025  # and than either of the two
FEWEST = 3  # frames in which it must turn clearly
_ELSEWHERE = np.radians(50.0)  # from the way
_CLEAR, _LEAST = np.radians(20.0), np.radians(10.0)  # what counts as turned clearly, and at all
_UNIT = np.radians(30.0)  # turning so far between two frames costs
_PRICE = 0.05  # this share of the usual misfit


def choices(angle: Floats, misfit: Floats, reference: int) -> Ints:
    """Which turn every limb takes in every frame.

    angle     : (frame, limb, turn) from where the limb was, radians; of the first turn nearly 0
    misfit    : (frame, limb, turn) 0 to 1, see `turns`
    reference : position of the frame in which every limb is as it is
    returns   : (frame, limb) turns, −1 where the limb stays; a limb stays everywhere unless much speaks against that
    """
    out = np.full(angle.shape[:2], -1, dtype=np.int64)
    for k in range(angle.shape[1]):
        way = _way(angle[:, k], misfit[:, k], reference)
        rows = np.arange(len(way))
        turned = np.where(rows == reference, 0.0, np.abs(angle[rows, k, way]))
        clear = turned > _CLEAR
        if clear.sum() >= FEWEST and _clearly(angle[clear, k], misfit[clear, k], way[clear]):
            out[:, k] = np.where(turned > _LEAST, way, -1)
    return out


def _clearly(angle: Floats, misfit: Floats, way: Ints) -> bool:
    """Whether a way fits better than no turn and than the best of all turns elsewhere; what is round fits as well there."""
    rows = np.arange(len(way))
    here = misfit[rows, way]
    apart = np.abs(np.angle(np.exp(1j * (angle - angle[rows, way][:, None]))))
    elsewhere = np.where(apart > _ELSEWHERE, misfit, 1.0).min(axis=1)
    better = (misfit[:, 0] - here).mean(), (elsewhere - here).mean()
    return bool(np.mean(better) > CLEARLY and min(better) > EITHER)


def _way(angle: Floats, misfit: Floats, reference: int) -> Ints:
    """(frame,) the turns that cost the least: Σ misfit / usual + price · (change of angle / 30°)², the first at `reference`."""
    usual = max(float(np.median(misfit.min(axis=1))), np.finfo(float).tiny)
    cost = misfit / usual
    cost[reference, 1:] = np.inf
    total, back = cost[0], np.zeros(angle.shape, dtype=np.int64)
    for t in range(1, len(angle)):
        change = np.angle(np.exp(1j * (angle[t - 1][:, None] - angle[t])))
        step = total[:, None] + _PRICE * (change / _UNIT) ** 2
        back[t] = step.argmin(axis=0)
        total = step.min(axis=0) + cost[t]
    way = [int(total.argmin())]
    for t in range(len(angle) - 1, 0, -1):
        way.append(int(back[t, way[-1]]))
    return np.array(way[::-1])
