"""Limbs that no cut tells from each other or from the trunk, as parts of their own (ours)."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.alike_limbs import alike_limbs
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.limbs_in_trunk import limbs_in_trunk
from kinetree.tasks.numerics.structure.part_motion import fit, residuals
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, joined, joints_of, part_tree
from kinetree.tasks.numerics.structure.pruning import NO_PART, Pruned

FIT_FLOOR = 1e-10
"""Least scale of squared residuals of a fit, share of the area: that of `EliminationSettings`."""


def with_limbs_apart(body: MovingSurface, state: Pruned, leaves: Ints, confidence: Floats, paired: float) -> Pruned:
    """The parts and their tree with two limbs that are one part cut apart, and a limb cut off the trunk with which it is one.

    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1
    paired     : radii, see `joint_partners.PAIRED`
    """
    pairs = limb_pairs(body.V, body.F, leaves)
    state = _with_two_for_one(body, state, leaves, pairs, confidence)
    return _off_the_trunk(body, state, pairs, confidence, paired)


def _with_two_for_one(body: MovingSurface, state: Pruned, leaves: Ints, pairs: LimbPairs, confidence: Floats) -> Pruned:
    """The same with two limbs of one part as two parts that move alike, unless one of both would hang on the other."""
    while True:
        for part, other in alike_limbs(body, state.parts, state.part_tree, leaves, pairs):
            apart = _cut_apart(body, state, part, other, confidence)
            if frozenset((part, len(apart.origin) - 1)) not in joints_of(apart.part_tree):
                state = apart
                break
        else:
            return state


def _off_the_trunk(body: MovingSurface, state: Pruned, pairs: LimbPairs, confidence: Floats, paired: float) -> Pruned:
    """The same with a limb that is one part with the trunk as a part that moves by itself, of every part one at most."""
    cut = set[int]()
    while True:
        found = limbs_in_trunk(body.F, state.parts, state.part_tree, pairs, body.area, paired=paired)
        one = next((one for one in found if one.part not in cut), None)
        if one is None:
            return state
        cut.add(one.part)
        apart = _cut_apart(body, state, one.part, one.limb, confidence)
        new = len(apart.origin) - 1
        apart = apart._replace(parts=_moving_by_themselves(body, apart.parts, [one.part, new], confidence))
        old = frozenset((one.part, one.below))
        parts = joined(body, apart.parts, joints_of(state.part_tree) - {old} | {frozenset((k, new)) for k in old})
        state = apart._replace(parts=parts, part_tree=part_tree(body, parts))


def _cut_apart(body: MovingSurface, state: Pruned, part: int, other: Ints, confidence: Floats) -> Pruned:
    """The same with some vertices of a part as a part of their own, the last, that moves as it does."""
    count = state.parts.R.shape[1]
    label, same = state.parts.label.copy(), [*range(count), part]
    label[other] = count
    R, t, residual = (np.ascontiguousarray(a[:, same]) for a in (state.parts.R, state.parts.t, state.parts.residual))
    share = confident_share(label, body.area, confidence, len(body.x), count + 1)
    parts = MovingParts(label, R, t, residual, share)
    return state._replace(parts=parts, part_tree=part_tree(body, parts), origin=np.append(state.origin, NO_PART))


def _moving_by_themselves(body: MovingSurface, parts: MovingParts, some: Sequence[int], confidence: Floats) -> MovingParts:
    """The same parts, some of them fitted anew; they explain no less than before."""
    R, t, residual = parts.R.copy(), parts.t.copy(), parts.residual.copy()
    V, x, weight = (
        np.ascontiguousarray(body.V),
        np.ascontiguousarray(body.x, np.float64),
        np.asfortranarray(confidence, np.float64),
    )
    are_these = np.isin(np.arange(R.shape[1]), some)
    fit(V, x, weight, body.area, parts.label, are_these, False, len(V), FIT_FLOOR * body.size**2, R, t)
    left = residuals(V, x, weight * body.area, R, t, parts.label)
    residual[:, are_these] = np.minimum(residual, left)[:, are_these]
    return parts._replace(R=R, t=t, residual=residual)
