"""Whose tree is used where every vertex was followed: the tree of the cut that the other cuts agree with most (ours).

Which joints a cut shows depends on where its rings and patches fall. A joint that two cuts have is likely one, a joint that one
cut has alone is likely flesh. Aligned vertices err alike in all cuts, so that there the first cut's tree is used.
"""

from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_consensus import GATE, same_joints


class PosedCut(NamedTuple):
    """A cut of the body in another pose.

    tree              : in the reference
    bare_joints       : (frame, joint, xyz) its joints without bones that no cut can find, mesh unit
    joints_with_bones : (frame, bone, xyz) the same with them
    """

    tree: FirstTree
    bare_joints: Floats
    joints_with_bones: Floats


class AgreeingCut(NamedTuple):
    """The cut whose tree is used.

    which   : 0 for the first one, k for the k-th of the others
    tree    : its tree, in the reference
    further : by other cut, (frame, joint, xyz) its joints, with bones that no cut can find if the tree has some
    """

    which: int
    tree: FirstTree
    further: list[Floats]


def agreeing_cut(first: FirstTree, others: Sequence[PosedCut], size: float) -> AgreeingCut:
    """The cut with most joints that another cut has too, less those that it has alone; of equals the first.

    size : root of the area, mesh unit
    """
    trees = [first, *(cut.tree for cut in others)]
    joints = [tree.motion.carried(tree.rest[1:]) for tree in trees]
    shared = [np.zeros(X.shape[1], np.bool_) for X in joints]
    for a, b in permutations(range(len(trees)), 2):
        shared[a][[i for i, _ in same_joints(joints[a], joints[b], GATE * size)]] = True
    which = int(np.argmax([has.sum() - (~has).sum() for has in shared]))
    if not which:
        return first_cut(first, others)
    tree = trees[which]
    further = _joints(others, tree)
    further[which - 1] = joints[0]
    return AgreeingCut(which, tree, further)


def first_cut(first: FirstTree, others: Sequence[PosedCut]) -> AgreeingCut:
    """The first cut, whatever the others say."""
    return AgreeingCut(0, first, _joints(others, first))


def _joints(others: Sequence[PosedCut], tree: FirstTree) -> list[Floats]:
    """By cut, its joints, with bones that no cut can find if the tree has some."""
    return [cut.joints_with_bones if tree.has_bones else cut.bare_joints for cut in others]
