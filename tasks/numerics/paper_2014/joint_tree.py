"""Joints and rigid parts in one tree (2014, Sec. 6.3.2)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.spanning_tree import spanning

Row = tuple[int, int, int]
"""Joint, part and parent of a node."""


class JointTree(NamedTuple):
    """A tree of nodes: each joint is one, with the part that turns about it; the first is the root's part and has no joint.

    joint   : (node,) area of the joint, −1 for the root
    part    : (node,) the rigid part that turns about the joint, of several the largest; −1 where only the joint's own area does
    parents : (node,) −1 for the root; parents come before children
    """

    joint: Ints
    part: Ints
    parents: Ints


def joint_tree(bone: Ints, bone_part: Ints, of_part: Flags, area: Floats, part_area: Floats) -> JointTree:
    """Rigid parts and joints as one tree, outwards from the largest part, along bones and then other adjacency (ours).

    bone      : (bone, 2) areas of the joints of the bones in the minimum spanning tree
    bone_part : (bone,) the part along which each runs, −1 for none
    of_part   : (part, area) whether a part is adjacent to a joint's area
    area      : (area,) mesh unit²
    part_area : (part,) mesh unit²
    """
    count, parts = len(area), len(part_area)
    links = [(int(j), count + int(p)) for (i, k), p in zip(bone, bone_part, strict=True) if p >= 0 for j in (i, k)]
    links += [(int(i), int(k)) for (i, k), p in zip(bone, bone_part, strict=True) if p < 0]
    of_bones = len(links)
    links += [(int(j), count + int(p)) for p, j in np.argwhere(of_part)]
    pair = np.array(links, np.int64).reshape(-1, 2)
    in_tree = spanning(pair, (np.arange(len(pair)) >= of_bones).astype(np.float64), count + parts)
    linked: dict[int, list[int]] = {}
    for a, b in pair[in_tree].tolist():
        linked.setdefault(a, []).append(b)
        linked.setdefault(b, []).append(a)
    joints = np.flatnonzero(of_part.any(axis=0) | np.isin(np.arange(count), bone))
    root = count + int(np.argmax(part_area)) if parts else int(joints[np.argmax(area[joints])]) if len(joints) else count
    rows: list[Row] = [(-1, root - count, -1) if root >= count else (-1, -1, -1)]
    _append_nodes(rows, linked, root, count, part_area)
    return JointTree(*(np.array(column, np.int64) for column in zip(*rows, strict=True)))


def _append_nodes(rows: list[Row], linked: dict[int, list[int]], root: int, count: int, size: Floats) -> None:
    """Appends a node for every joint with the largest of the parts beyond it, if there are any; parts begin at `count`.

    The other parts beyond a joint follow its node, so that what hangs on them hangs on it.
    """
    queue, visited = [(root, 0)], {root}
    for item, node in queue:
        for joint in sorted(j for j in linked.get(item, []) if j not in visited and j < count):
            beyond = sorted(b for b in linked.get(joint, []) if b not in visited)
            parts = [b for b in beyond if b >= count]
            visited.update((joint, *parts))
            rows.append((joint, max(parts, key=lambda b: size[b - count]) - count if parts else -1, node))
            queue += [(b, len(rows) - 1) for b in (*parts, joint)]
