"""Which joints of mirrored limbs are mirror images of each other, by their distances from the ends of the limbs (ours)."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import PartTree

PAIRED = 2.5
"""By how much two joints of mirrored limbs may differ in their distance from the end of the limb to be partners, radii of the
smaller border. Of 416 true partners of 96 bodies the farthest differ by 2.3."""


class Limb(NamedTuple):
    """A limb from its end inwards.

    part  : (part,) place of each part in the tree
    level : (part,) distance of its joint from the end over the surface, mesh unit; infinite where no path leads
    """

    part: Ints
    level: Floats


class RootedParts(NamedTuple):
    """Parts in a tree, a part after its parent.

    place   : (vertex,) of each vertex's part in the tree
    parents : (part,) −1 for the root
    radius  : (part,) of the border with the parent, mesh unit; 0 for the root
    """

    place: Ints
    parents: Ints
    radius: Floats

    @classmethod
    def of(cls, label: Ints, found: PartTree) -> "RootedParts":
        """Those of a tree; label (vertex,) part, by its number."""
        tree = found.tree
        return cls(np.argsort(tree.order)[label], tree.parents, np.append(0.0, found.borders.radius[tree.border[1:]]))


class MirroredLimbs(NamedTuple):
    """Two limbs up to the part that carries both, and which of their joints are mirror images.

    one, other : the limbs
    row        : (partners, 2) positions within both
    """

    one: Limb
    other: Limb
    row: Ints


def mirrored_limbs(F: Ints, parts: RootedParts, pairs: LimbPairs, paired: float = PAIRED) -> Iterator[MirroredLimbs]:
    """Both limbs of every pair; a limb whose end lies in the other one has no parts, nor has any of a body of one part.

    F      : (face, corner)
    paired : radii, see `PAIRED`
    """
    if len(parts.parents) < 2:
        return
    for tips, away in zip(*pairs, strict=True):
        one, other = _limbs(F, parts, tips, away)
        yield MirroredLimbs(one, other, _partners(one, other, parts.radius, paired))


def joint_partners(F: Ints, parts: RootedParts, pairs: LimbPairs, paired: float = PAIRED) -> Ints:
    """(part,) the part whose joint is the mirror image of each one's; −1 where there is none.

    F, paired : as `mirrored_limbs` takes them
    """
    partner = np.full(len(parts.parents), -1)
    for one, other, row in mirrored_limbs(F, parts, pairs, paired):
        a, b = one.part[row[:, 0]], other.part[row[:, 1]]
        free = (partner[a] < 0) & (partner[b] < 0)  # two ends of one limb each have a pair
        partner[a[free]], partner[b[free]] = b[free], a[free]
    return partner


def bone_asymmetry(parents: Ints, partner: Ints, length: Floats) -> Floats:
    """(joint,) difference between the lengths of a joint's bone and of that bone's mirror image; NaN where it has none.

    Of bones that are mirror images both ends are, or the ends nearer to the root are one.

    parents, partner : (joint,) the joint above each one, and its mirror image; −1 where there is none
    length           : (joint,) of the bone from the joint above
    """
    above = parents[partner]
    is_one = (parents == above) | (partner[parents] == above)
    return np.where((partner >= 0) & (parents >= 0) & is_one, np.abs(length - length[partner]), np.nan)


def symmetry(F: Ints, parts: RootedParts, pairs: LimbPairs, paired: float = PAIRED) -> int:
    """Pairs of partners, less the joints of mirrored limbs that have no partner.

    F, paired : as `mirrored_limbs` takes them
    """
    has = joint_partners(F, parts, pairs, paired) >= 0
    return int(has.sum()) // 2 - int((in_mirrored_limbs(parts, pairs) & ~has).sum())


def in_mirrored_limbs(parts: RootedParts, pairs: LimbPairs) -> Flags:
    """(part,) whether a part is of a limb that has a mirror image."""
    inside, below = np.zeros(len(parts.parents), np.bool_), beyond(parts.parents) > 0
    for tips in pairs.tip:
        inside[_own(below[:, parts.place[tips]]).any(axis=1)] = True
    return inside


def joints_between_pairs(parts: RootedParts, pairs: LimbPairs) -> Ints:
    """(joint,) the joints between pairs of limbs, as those of a spine: both ends of each pair lie on one side, and on either
    side those of one pair at least.
    """
    is_beyond = beyond(parts.parents)[:, parts.place[pairs.tip]] > 0  # (joint, pair, 2)
    is_together = (is_beyond[:, :, 0] == is_beyond[:, :, 1]).all(axis=1)
    beside = is_beyond[:, :, 0]
    return np.flatnonzero(is_together & beside.any(axis=1) & ~beside.all(axis=1))


def parts_touch(F: Ints, label: Ints, one: int, other: int) -> bool:
    """Whether an edge leads from one part to the other; F (face, corner), label (vertex,) part."""
    edge = label[np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])]
    return bool(((edge == one).any(axis=1) & (edge == other).any(axis=1)).any())


def _own(carrying: Flags) -> Flags:
    """(part, 2) which parts carry one of two ends alone; carrying (part, 2) whether each carries each of them."""
    return carrying & ~carrying.all(axis=1, keepdims=True)


def _limbs(F: Ints, parts: RootedParts, tips: Ints, away: Floats) -> tuple[Limb, Limb]:
    """Both limbs of a pair up to the part that carries both."""
    place, parents, _ = parts
    edge = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    below = beyond(parents) > 0
    limbs = []
    for own, distance in zip(_own(below[:, place[tips]]).T, away, strict=True):
        part = np.flatnonzero(own)[::-1]
        inside = below[part][:, place]
        level = [_mean_distance(distance[edge[within[edge].sum(axis=1) == 1]]) for within in inside]
        limbs.append(Limb(part, np.array(level)))
    return limbs[0], limbs[1]


def _mean_distance(distance: Floats) -> float:
    """Of those that a path leads to; infinite where there is none."""
    reached = distance[np.isfinite(distance)]
    return float(reached.mean()) if len(reached) else np.inf


def _partners(one: Limb, other: Limb, radius: Floats, paired: float) -> Ints:
    """(partners, 2) rows of joints of two limbs that lie equally far from their ends; the least sum of differences.

    Partners follow each other alike from the ends inwards: exchanged they may leave the same sum, where one limb's joints all
    lie farther from the end.
    """
    with np.errstate(invalid="ignore"):  # joints that no path leads to have no partner
        apart = np.abs(one.level[:, None] - other.level) / np.minimum(radius[one.part][:, None], radius[other.part])
    cost = np.minimum(np.nan_to_num(apart, nan=paired, posinf=paired), paired)
    row = np.stack(linear_sum_assignment(cost), axis=1)
    row = row[cost[row[:, 0], row[:, 1]] < paired]
    return np.stack([row[:, 0], np.sort(row[:, 1])], axis=1)
