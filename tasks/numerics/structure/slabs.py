"""Slabs of flesh beside hidden bones: parts of a cut that one hidden bone explains as well without them (ours).

Skin that blends over a short neck or a spine may have a slice that a cut makes a part. Beside it a hidden bone is then one too
many: the slab moves as a mixture of the bone and the next part. Its two joints lie close to each other, as one does.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Ints
from kinetree.tasks.numerics.structure.inserted_bones import inserted_bones
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import NO_PART
from kinetree.tasks.numerics.structure.tree_joints import KinematicTreeSettings, TreeJoints, without_part


class SlabsSettings(NamedTuple):
    """What makes a part beside a hidden bone a slab."""

    length: float = 0.9
    """Distance between its joints in radii of their borders, at most: as near as those of a hidden bone may not lie. False
    parts of people of even seeds have 0.10 to 0.74."""
    worse: float = 1.5
    """Largest drift of the bone's joints without it, in that of the joints with it, at most. False parts of people of even
    seeds have 0.6 to 1.4, one 2.1; a true one of a recorded neck 1.8."""
    one_point: float = 0.25
    """Distance between its joints in radii of their borders below which they are one, however much the bone's joints drift
    without it: half-way between false parts of people of even seeds, 0.10 and 0.13, and the true one, 0.35."""


class Slab(NamedTuple):
    """A part that may be a slab.

    part   : by its number before any was dropped
    beside : the parts beyond the slab and beyond the bone, by the same numbers
    most   : drift of the bone's joints without it in the take in which they drift most, at most, mesh unit
    """

    part: int
    beside: frozenset[int]
    most: float


def bones_without_slabs(
    body: MovingSurface, found: TreeJoints, settings: KinematicTreeSettings, slabs: SlabsSettings | None = None
) -> TreeJoints:
    """The tree with its hidden bones, see `inserted_bones`; of several takes without parts that one of them explains as well.

    A single take may turn a spine too little to tell: of a walking person the chest was placed worse without its slab.

    body : every vertex of it was followed
    """
    chosen, noise = slabs or SlabsSettings(), settings.noise * body.size
    whole = inserted_bones(body, found, noise)
    if len(body.takes or ()) < 2:
        return whole
    tried: set[int] = set()
    while slab := next((s for s in _slabs(body, whole, chosen) if s.part not in tried), None):
        tried.add(slab.part)
        number = int(np.flatnonzero(found.left.origin == slab.part)[0])
        fewer = without_part(body, found, number, settings)
        bones = inserted_bones(body, fewer, noise)
        if _explains(body, bones, slab):
            found, whole = fewer, bones
    return whole


def _slabs(body: MovingSurface, joints: TreeJoints, chosen: SlabsSettings) -> Iterator[Slab]:
    """Short parts between a hidden bone and one other part, which is not hidden."""
    tree, drift = joints.left.part_tree.tree, joints.widest_drift(body.takes)
    origin = joints.left.origin[tree.order]
    radius = joints.left.part_tree.borders.radius[tree.border]
    for bone in np.flatnonzero(origin == NO_PART).tolist():
        sides = _beside(tree.parents, bone)
        for part, far in (sides, sides[::-1]) if len(sides) == 2 else ():
            ends = [k for k in _beside(tree.parents, part) if k != bone]
            if origin[part] == NO_PART or len(ends) != 1 or NO_PART in origin[[far, ends[0]]]:
                continue
            rows = [_joint(tree.parents, a, b) for a, b in ((bone, part), (part, ends[0]), (bone, far))]
            length = float(np.linalg.norm(joints.rest[rows[0]] - joints.rest[rows[1]]) / radius[rows[:2]].mean())
            if length < chosen.length:
                most = np.inf if length < chosen.one_point else chosen.worse * float(drift[rows].max())
                yield Slab(int(origin[part]), frozenset(origin[[far, ends[0]]].tolist()), most)


def _explains(body: MovingSurface, bones: TreeJoints, slab: Slab) -> bool:
    """Whether a hidden bone joins what is beside the slab and its bone, about joints that do not drift too much."""
    tree, drift = bones.left.part_tree.tree, bones.widest_drift(body.takes)
    origin = bones.left.origin[tree.order]
    for bone in np.flatnonzero(origin == NO_PART).tolist():
        sides = _beside(tree.parents, bone)
        if frozenset(origin[sides].tolist()) == slab.beside:
            rows = [_joint(tree.parents, bone, side) for side in sides]
            return bool(drift[rows].max() <= slab.most)
    return False


def _beside(parents: Ints, part: int) -> list[int]:
    """The neighbours of a part in the tree."""
    above = [int(parents[part])] if parents[part] >= 0 else []
    return above + np.flatnonzero(parents == part).tolist()


def _joint(parents: Ints, a: int, b: int) -> int:
    """The place of the joint between two neighbours: that of the lower one."""
    return a if parents[a] == b else b
