"""Parts of one limb that its mirror image lacks: rings of flesh, since joints come in pairs (ours).

A ring of flesh beside a joint is a part in one cut and none in the next, and in one limb of a pair and not in the other. So a
joint without a partner in the mirror image of its limb, close to one that has a partner, is no joint. A true part of the
trunk may carry one of two limbs in the tree alone: it moves the other limb as well as the part which that hangs on.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, PartTree
from kinetree.tasks.numerics.structure.rotation_centres import rotation_centres


class UnpairedPartsSettings(NamedTuple):
    """What makes a part with an unpaired joint flesh; lengths in radii of the smaller border. See RESULTS."""

    paired: float = 2.5
    """By how much two joints of mirrored limbs may differ in their distance from the end of the limb to be partners."""
    near: float = 1.8
    """Distance of the unpaired joint from a paired one beside it, at most."""
    near_end: float = 1.25
    """The same of the outermost joint of a limb: the ball of a foot lies close to the ankle."""
    carries: float = 1.33
    """Drift of the mirrored limb's joint on a part of the trunk, in its drift where it hangs, below which that part carries
    both."""
    noise: float = 0.065
    """That drift, in radii of its border, below which the part carries both whatever it is where the limb hangs; not used where
    every vertex was followed. A slice of wave's pelvis has 0.060, flesh beside a shoulder of human 9 0.077."""


class _Limb(NamedTuple):
    """A limb from its end inwards.

    part  : (part,) place of each part in the tree
    level : (part,) distance of its joint from the end over the surface, mesh unit
    """

    part: Ints
    level: Floats


class _Slice(NamedTuple):
    """A part between an unpaired joint and a paired one.

    part     : its place in the tree
    distance : between the two joints, in radii of the smaller border
    on_trunk : whether it hangs on what carries both limbs
    mirrored : place of the innermost part of the other limb
    """

    part: int
    distance: float
    on_trunk: bool
    mirrored: int


def unpaired_parts(
    F: Ints, parts: MovingParts, found: PartTree, pairs: LimbPairs, settings: UnpairedPartsSettings | None = None
) -> Iterator[int]:
    """The parts that are likely rings of flesh, by their numbers, those whose joints lie nearest to each other first.

    F     : (face, corner)
    found : the tree of the parts
    """
    if len(found.tree.order) < 2:
        return
    chosen = settings or UnpairedPartsSettings()
    slices = [s for tips, away in zip(*pairs, strict=True) for s in _slices(F, parts.label, found, tips, away, chosen)]
    for piece in sorted(slices, key=lambda s: (s.distance, s.part)):
        if not piece.on_trunk or not _carries_both(parts, found, piece, chosen):
            yield int(found.tree.order[piece.part])


def unpaired_joints(
    F: Ints, label: Ints, found: PartTree, pairs: LimbPairs, settings: UnpairedPartsSettings | None = None
) -> int:
    """How many joints of all pairs of limbs have no partner.

    F     : (face, corner)
    label : (vertex,) part
    """
    if len(found.tree.order) < 2:
        return 0
    chosen, radius = settings or UnpairedPartsSettings(), found.borders.radius[found.tree.border]
    place, count = np.argsort(found.tree.order)[label], 0
    for tips, away in zip(*pairs, strict=True):
        limbs = _limbs(F, place, found.tree.parents, tips, away)
        count += sum(int((~has).sum()) for has in _have_partners(*limbs, radius, chosen))
    return count


def _slices(F: Ints, label: Ints, found: PartTree, tips: Ints, away: Floats, chosen: UnpairedPartsSettings) -> Iterator[_Slice]:
    """The parts between an unpaired joint and a paired one near it, of both limbs of a pair."""
    parents, row = found.tree.parents, found.tree.border
    radius, rest = found.borders.radius[row], found.joints.rest[row]
    one, other = _limbs(F, np.argsort(found.tree.order)[label], parents, tips, away)
    if not len(one.part) or not len(other.part):
        return
    for limb, mirror, has_partner in zip((one, other), (other, one), _have_partners(one, other, radius, chosen), strict=True):
        for joint in np.flatnonzero(~has_partner).tolist():
            for beside in (joint - 1, joint + 1):
                if 0 <= beside < len(limb.part) and has_partner[beside]:
                    a, b = limb.part[[joint, beside]]
                    inner = max(joint, beside)
                    part = int(limb.part[inner])
                    distance = float(np.linalg.norm(rest[a] - rest[b]) / max(min(radius[a], radius[b]), np.finfo(float).tiny))
                    if (parents == part).sum() == 1 and distance < (chosen.near_end if joint == 0 else chosen.near):
                        yield _Slice(part, distance, inner == len(limb.part) - 1, int(mirror.part[-1]))


def _limbs(F: Ints, place: Ints, parents: Ints, tips: Ints, away: Floats) -> tuple[_Limb, _Limb]:
    """Both limbs of a pair up to the part that carries both; place (vertex,) of each vertex's part in the tree."""
    edge = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    below = beyond(parents) > 0
    carrying = below[:, place[tips]]
    limbs = []
    for own, distance in zip(carrying.T, away, strict=True):
        part = np.flatnonzero(own & ~carrying.all(axis=1))[::-1]
        inside = below[part][:, place]
        level = [_mean_distance(distance[edge[within[edge].sum(axis=1) == 1]]) for within in inside]
        limbs.append(_Limb(part, np.array(level)))
    return limbs[0], limbs[1]


def _mean_distance(distance: Floats) -> float:
    """Of those that a path leads to; infinite where there is none."""
    reached = distance[np.isfinite(distance)]
    return float(reached.mean()) if len(reached) else np.inf


def _have_partners(one: _Limb, other: _Limb, radius: Floats, chosen: UnpairedPartsSettings) -> tuple[Flags, Flags]:
    """Which joints of two limbs are as far from their ends as one of the other limb."""
    with np.errstate(invalid="ignore"):  # joints that no path leads to have no partner
        apart = np.abs(one.level[:, None] - other.level) / np.minimum(radius[one.part][:, None], radius[other.part])
    cost = np.minimum(np.nan_to_num(apart, nan=chosen.paired, posinf=chosen.paired), chosen.paired)
    rows, columns = linear_sum_assignment(cost)
    close = cost[rows, columns] < chosen.paired
    flags = np.zeros(len(one.part), np.bool_), np.zeros(len(other.part), np.bool_)
    flags[0][rows[close]] = True
    flags[1][columns[close]] = True
    return flags


def _carries_both(parts: MovingParts, found: PartTree, piece: _Slice, chosen: UnpairedPartsSettings) -> bool:
    """Whether the mirrored limb might as well hang on the part: its joint drifts hardly more there than where it hangs, or by
    no more than aligned vertices err.
    """
    tree, row = found.tree, int(found.tree.border[piece.mirrored])
    limb, own, part = tree.order[[piece.mirrored, tree.parents[piece.mirrored], piece.part]]
    centre, radius = np.repeat(found.borders.centre[row][None], 2, axis=0), np.repeat(found.borders.radius[row], 2)
    pair = np.array([[limb, part], [limb, own]])
    on_part, on_own = rotation_centres(parts.R, parts.t, pair, centre, radius, parts.residual, parts.confidence).drift
    noise = 0.0 if parts.confidence is None else chosen.noise * radius[0]
    return bool(on_part < max(chosen.carries * on_own, noise))
