"""Slices of flesh across the trunk: a cut's part between joints that are one (ours).

An arm that greets pulls one side of the chest along, so that a cut has a joint before the chest's and one beyond. They lie as
near to each other as two joints of a trunk never do. Flesh about two hips, in the same way, turns by a share of what both
thighs turn by: it is a part that carries both and nothing else, and whose own joint lies amid theirs.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.mirrored_slices import Slice, slice_between
from kinetree.tasks.numerics.structure.part_tree import MovingSurface

NEAR = 0.65
"""Distance between the two joints in radii of the smaller border, below which they are one. Of 152 bodies three have slices,
with 0.49 to 0.57; of the 26 pairs of true joints within 1.35 radii three have 0.77 to 0.9, the others 1.05 and more."""

AMID = 0.6
"""Distance of a part's joint from the middle between the two limbs of a pair that it carries, in radii of its border, below
which it is flesh about them, if it carries nothing else. People 14, 758 and 781 have such flesh, with 0.22 to 0.29; chests
and pelvises have 0.75 and more but for that of the ballet (every fourth frame), which carries a neck too."""


def trunk_slices(body: MovingSurface, tree: FirstTree, leaves: Ints, pairs: LimbPairs) -> list[Slice]:
    """The parts of the trunk that are slices, none beside another one.

    leaves : (leaf,) vertices at the ends of limbs
    pairs  : limbs that are mirror images
    """
    found: list[Slice] = []
    of_trunk = _of_trunk(tree, leaves)
    for part in np.flatnonzero(of_trunk & (tree.parents >= 0)).tolist():
        beside = {k for one in found for k in (one.part, *one.below)}
        if {part, int(tree.parents[part])} & beside:
            continue
        below = np.flatnonzero(tree.parents == part)
        if _is_amid_limbs(tree, part, pairs):
            found.append(Slice(part, int(tree.parents[part]), tuple(below.tolist()), np.full(len(body.V), np.inf)))
            continue
        near = [k for k in below[of_trunk[below]].tolist() if _distance(tree, part, tree.rest[k], tree.radius[k]) < NEAR]
        if near:
            found.append(slice_between(body, tree, near[0], part))
    return found


def _of_trunk(tree: FirstTree, leaves: Ints) -> Flags:
    """(part,) whether each carries two ends of limbs or more."""
    carried = beyond(tree.parents)[:, tree.label[leaves]].sum(axis=1)
    return np.asarray(carried >= 2)


def _is_amid_limbs(tree: FirstTree, part: int, pairs: LimbPairs) -> bool:
    """Whether both limbs of a pair, and nothing else, hang on a part whose joint lies amid theirs."""
    below = np.flatnonzero(tree.parents == part)
    ends = beyond(tree.parents)[:, tree.label[pairs.tip]] > 0  # (part, pair, 2)
    if len(below) != 2 or not (ends[below[0]] & ends[below[1], :, ::-1]).any():
        return False
    return _distance(tree, part, tree.rest[below].mean(axis=0), np.inf) < AMID


def _distance(tree: FirstTree, part: int, place: Floats, radius: float) -> float:
    """Of a part's joint from a place, in radii of its border or of this one, of the smaller."""
    smaller = max(min(float(tree.radius[part]), radius), float(np.finfo(float).tiny))
    return float(np.linalg.norm(tree.rest[part] - place)) / smaller
