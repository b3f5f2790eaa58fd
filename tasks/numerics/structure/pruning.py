"""Which parts are parts: joints turn by themselves and more than they drift; the rest is flesh, cloth or error.

A part that fails is dropped and its vertices go to the parts around it, never merged as a rigid whole: merging by a bad
border once made two parts of a body. Everything around is then found anew. A part stays if without it the worst joint
would be worse.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.structure.joint_evidence import Seen, least_evident_joint
from kinetree.tasks.numerics.structure.joint_rotations import in_between
from kinetree.tasks.numerics.structure.part_tree import Carried, PartTree, Surfaces, against, part_tree
from kinetree.tasks.numerics.structure.vertex_reassignment import handed_over

LEAST_DEGREES = 6.0
LEAST_RATIO = 0.8
"""What turning must move a part by, against what its joint drifts by."""
LEAF_RATIO = 0.5
"""The same for the last part of a limb that has a leaf: hands and feet are small."""
FLAP_RATIO = 3.0
"""The same for a last part without a leaf: few bodies have a limb there."""
CLEAR_RATIO = 3.0
"""A part between a poor joint and one as good as this stays."""
FLESH = 0.92
"""Share of a part's turning that follows from that of the part beyond it, above which it is flesh around a joint."""
THIN = 1.25
"""Length of such a part at most, from joint to joint in radii of its borders."""
WORSE = 0.9


class Pruned(NamedTuple):
    """The parts that are left, and the tree they hang in."""

    parts: Carried
    part_tree: PartTree


def pruned(
    body: Surfaces,
    parts: Carried,
    leaves: Ints,
    seen: Seen | None = None,
    *,
    degrees: float = LEAST_DEGREES,
    ratio: float = LEAST_RATIO,
) -> Pruned:
    """Drops parts, the most doubtful first, until none is doubtful or none can be spared; then those that no surface shows.

    leaves         : (leaf,) vertices at the ends of limbs
    seen           : the frames' surfaces; None where every vertex was followed
    degrees, ratio : what a joint must turn by, and how many times farther than it drifts
    """
    start, ring = rings(body.F, len(body.V))
    left = _spared(body, parts, leaves, degrees, ratio)
    while seen is not None and (gone := least_evident_joint(body, left.parts, left.part_tree, seen)) >= 0:
        label = handed_over(body.V, body.x, left.parts.label, gone, left.parts.R, left.parts.t, start, ring)
        left = _spared(body, left.parts.without(gone, label), leaves, degrees, ratio)
    return left


def _spared(body: Surfaces, parts: Carried, leaves: Ints, degrees: float, ratio: float) -> Pruned:
    start, ring = rings(body.F, len(body.V))
    found = part_tree(body, parts)
    while True:
        for gone in _doubtful(body, parts, found, leaves, degrees, ratio):
            label = handed_over(body.V, body.x, parts.label, gone, parts.R, parts.t, start, ring)
            fewer = parts.without(gone, label)
            without = part_tree(body, fewer)
            if without.ratio.min() >= WORSE * found.ratio.min():
                parts, found = fewer, without
                break
        else:
            return Pruned(parts, found)


def _doubtful(body: Surfaces, parts: Carried, found: PartTree, leaves: Ints, degrees: float, ratio: float) -> list[int]:
    """Parts that may be none, the most doubtful first: flesh, then what turns too little, then what drifts too much."""
    tree, mass = found.tree, np.bincount(parts.label, body.area, parts.R.shape[1])
    has_leaf = np.isin(np.arange(len(mass)), parts.label[leaves])
    doubts = [(_flesh(parts.R, found, k), int(part)) for k, part in enumerate(tree.order)]
    for k in range(1, len(mass)):
        part, above = int(tree.order[k]), int(tree.order[tree.parents[k]])
        smaller = min((part, above), key=lambda p: (mass[p], p))
        last = not (tree.parents == k).any()
        doubts.append((found.degrees[k] / max(degrees, 1e-9), smaller))
        if last and not has_leaf[part]:
            doubts.append((found.ratio[k] / max(FLAP_RATIO / LEAST_RATIO * ratio, 1e-9), part))
            continue
        least = LEAF_RATIO / LEAST_RATIO * ratio if last else ratio
        spare = [p for p in (smaller, part + above - smaller) if not _bears(found, p, k)]
        doubts += [(found.ratio[k] / max(least, 1e-9), p) for p in spare[:1]]
    return list(dict.fromkeys(part for doubt, part in sorted(doubts) if doubt < 1.0))


def _bears(found: PartTree, part: int, k: int) -> bool:
    """Whether a part has a clear joint other than the k-th."""
    tree = found.tree
    place = int(np.flatnonzero(tree.order == part)[0])
    others = (tree.parents == place) | (np.arange(len(tree.order)) == place)
    others[[0, k]] = False
    return bool((found.ratio[others] >= CLEAR_RATIO).any())


def _flesh(R: Floats, found: PartTree, k: int) -> float:
    """Below 1, and the lower the clearer, where the part at the k-th place is a ring of flesh between two neighbours."""
    tree = found.tree
    children = np.flatnonzero(tree.parents == k)
    if k == 0 and len(children) != 2:
        return np.inf
    ends = [(int(children[0]), int(children[1]))] if k == 0 else [(k, int(c)) for c in children]
    return min((_ring(R, found, k, *pair) for pair in ends), default=np.inf)


def _ring(R: Floats, found: PartTree, k: int, one: int, other: int) -> float:
    """The same, asked of two of its joints: how near they are, if it turns by a share of what both turn by."""
    tree = found.tree
    rows = tree.border[[one, other]]
    apart = float(np.linalg.norm(np.diff(found.joints.rest[rows], axis=0)))
    reach = THIN * float(found.borders.radius[rows].min())
    top = int(tree.order[one if k == 0 else tree.parents[k]])
    ring, end = int(tree.order[k]), int(tree.order[other])
    if apart > reach or in_between(against(R, top, ring), against(R, top, end)) < FLESH:
        return np.inf
    return apart / reach - 1.0
