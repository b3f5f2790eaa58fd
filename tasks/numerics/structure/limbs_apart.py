"""Limbs that no cut tells from each other or from the trunk, as parts of their own (ours)."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.alike_limbs import alike_limbs
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.limbs_in_trunk import LimbInTrunk, limbs_in_trunk
from kinetree.tasks.numerics.structure.part_motion import fit, misfit, residuals
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, joints_of, part_tree
from kinetree.tasks.numerics.structure.pruning import NO_PART, Pruned

FIT_FLOOR = 1e-10
"""Least scale of squared residuals of a fit, share of the area: that of `EliminationSettings`."""


def with_limbs_apart(
    body: MovingSurface, state: Pruned, leaves: Ints, pairs: LimbPairs, confidence: Floats, paired: float
) -> Pruned:
    """The parts and their tree with two limbs that are one part cut apart, and a limb cut off the trunk with which it is one.

    leaves     : (leaf,) vertices at the ends of limbs
    pairs      : those that are mirror images
    confidence : (frame, vertex) 0 to 1
    paired     : radii, see `joint_partners.PAIRED`
    """
    return _with_limbs_off_trunk(body, _with_two_limbs(body, state, leaves, pairs, confidence), pairs, confidence, paired)


def _with_two_limbs(body: MovingSurface, state: Pruned, leaves: Ints, pairs: LimbPairs, confidence: Floats) -> Pruned:
    """The same with two limbs of one part as two parts that move alike, unless one of both would hang on the other."""
    while True:
        for part, other in alike_limbs(body, state.parts, state.part_tree, leaves, pairs):
            parts = _cut_apart(body, state.parts, part, other, confidence)
            apart = _with_one_more(body, state, parts)
            if frozenset((part, len(apart.origin) - 1)) not in joints_of(apart.part_tree):
                state = apart
                break
        else:
            return state


def _with_limbs_off_trunk(body: MovingSurface, state: Pruned, pairs: LimbPairs, confidence: Floats, paired: float) -> Pruned:
    """The same with limbs that are one part with the trunk as parts that move by themselves, each part asked once."""
    asked = set[int]()
    while True:
        found = limbs_in_trunk(body.F, state.parts, state.part_tree, pairs, body.area, paired=paired)
        one = next((one for one in found if one.part not in asked), None)
        if one is None:
            return state
        asked.add(one.part)
        state = _with_limb(body, state, one, confidence)


def _with_limb(body: MovingSurface, state: Pruned, one: LimbInTrunk, confidence: Floats) -> Pruned:
    """The same with one limb cut off, between the part and the next one of the limb; all other joints stay. As it is where the
    limb would not hang so.
    """
    new = state.parts.R.shape[1]
    parts = _cut_apart(body, state.parts, one.part, one.limb, confidence)
    parts = moving_by_themselves(body, parts, [one.part, new], confidence)
    hip, knee = frozenset((one.part, new)), frozenset((new, one.below))
    joints = joints_of(state.part_tree) - {frozenset((one.part, one.below))} | {hip, knee}
    apart = _with_one_more(body, state, parts._replace(joined=joints, by_shape=parts.by_shape | {hip}))
    return apart if {hip, knee} <= joints_of(apart.part_tree) else state


def _with_one_more(body: MovingSurface, state: Pruned, parts: MovingParts) -> Pruned:
    """The tree of these parts, of which the cut does not have the last."""
    return state._replace(parts=parts, part_tree=part_tree(body, parts), origin=np.append(state.origin, NO_PART))


def _cut_apart(body: MovingSurface, parts: MovingParts, part: int, other: Ints, confidence: Floats) -> MovingParts:
    """The same with some vertices of a part as a part of their own, the last, that moves as it does."""
    count = parts.R.shape[1]
    label, same = parts.label.copy(), [*range(count), part]
    label[other] = count
    R, t, residual = (np.ascontiguousarray(a[:, same]) for a in (parts.R, parts.t, parts.residual))
    share = confident_share(label, body.area, confidence, len(body.x), count + 1)
    return parts._replace(label=label, R=R, t=t, residual=residual, confidence=share)


def moving_by_themselves(body: MovingSurface, parts: MovingParts, some: Sequence[int], confidence: Floats) -> MovingParts:
    """The same parts, some of them fitted anew; of these, vertices count that follow them as half of their vertices do.

    confidence : (frame, vertex) 0 to 1
    """
    R, t, residual, label = parts.R.copy(), parts.t.copy(), parts.residual.copy(), parts.label
    V, x = (np.array(a, np.float64, order="C") for a in (body.V, body.x))
    weight = np.array(confidence, np.float64, order="F")
    are_these, floor = np.isin(np.arange(R.shape[1]), some), FIT_FLOOR * body.size**2
    fit(V, x, weight, body.area, label, are_these, False, len(V), floor, R, t)
    square, clear = misfit(V, x, weight, R, t, label), np.ones(len(V))
    for part in some:
        own = label == part
        half = max(float(np.median(square[own])), floor)
        clear[own] = half / (half + square[own])
    residual[:, are_these] = residuals(V, x, weight * (body.area * clear), R, t, label)[:, are_these]
    return parts._replace(R=R, t=t, residual=residual)
