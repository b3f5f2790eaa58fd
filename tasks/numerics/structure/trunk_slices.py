"""Slices of flesh across the trunk: a cut's part between two joints that are one, which lies between them (ours).

An arm that greets pulls one side of the chest along, so that a cut has a joint before the chest's and one beyond. They lie as
near to each other as two joints of a trunk never do.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.mirrored_slices import Slice, slice_between
from kinetree.tasks.numerics.structure.part_tree import MovingSurface

NEAR = 0.65
"""Distance between the two joints in radii of the smaller border, below which they are one. Of 152 bodies three have slices,
with 0.49 to 0.57; of the 26 pairs of true joints within 1.35 radii three have 0.77 to 0.9, the others 1.05 and more."""


def trunk_slices(body: MovingSurface, tree: FirstTree, leaves: Ints) -> list[Slice]:
    """The parts of the trunk that are slices, none beside another one.

    leaves : (leaf,) vertices at the ends of limbs
    """
    found: list[Slice] = []
    of_trunk = _of_trunk(tree, leaves)
    for part in np.flatnonzero(of_trunk & (tree.parents >= 0)).tolist():
        for below in np.flatnonzero(of_trunk & (tree.parents == part)).tolist():
            radius = max(float(min(tree.radius[[part, below]])), float(np.finfo(float).tiny))
            is_near = np.linalg.norm(tree.rest[part] - tree.rest[below]) < NEAR * radius
            if is_near and not {part, int(tree.parents[part])} & {k for one in found for k in (one.part, one.below)}:
                found.append(slice_between(body, tree, below, part))
    return found


def _of_trunk(tree: FirstTree, leaves: Ints) -> Flags:
    """(part,) whether each carries two ends of limbs or more."""
    carried = beyond(tree.parents)[:, tree.label[leaves]].sum(axis=1)
    return np.asarray(carried >= 2)
