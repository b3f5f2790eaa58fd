"""Whose tree is used where every vertex was followed: the tree of the cut that the other cuts agree with most (ours).

Which joints a cut shows depends on where its rings and patches fall. A joint that two cuts have is likely one, a joint that one
cut has alone is likely flesh; of two cuts neither is in the majority. Aligned vertices err alike in all cuts, so that there the
first cut's tree is used.
"""

from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_consensus import GATE, same_joints


class CutJoints(NamedTuple):
    """The joints of a cut in another pose.

    bare       : (frame, joint, xyz) without bones that no cut can find, mesh unit
    with_bones : (frame, bone, xyz) with them, mesh unit
    """

    bare: Floats
    with_bones: Floats

    def beside(self, tree: FirstTree) -> Floats:
        """Those with bones that no cut can find if the tree has some."""
        return self.with_bones if tree.has_bones else self.bare


class AgreeingCut(NamedTuple):
    """The cut whose tree is used.

    which   : 0 for the first one, k for the k-th of the others
    tree    : its tree, in the reference
    further : by other cut, (frame, joint, xyz) its joints, see `CutJoints.beside`; those of the first cut as its tree has them
    """

    which: int
    tree: FirstTree
    further: list[Floats]


def agreeing_cut(first: FirstTree, others: Sequence[FirstTree], joints: Sequence[CutJoints], size: float) -> AgreeingCut:
    """The cut with most joints that another cut has too, less those that it has alone; of equals the first.

    It has such a joint, and no fewer of them than the first cut, so that a cut which shows little never wins. Of two cuts it is
    the first.

    others, joints : trees of the other cuts, in the reference, and their joints
    size           : root of the area, mesh unit
    """
    if len(others) < 2:
        return first_cut(first, joints)
    trees = [first, *others]
    carried = [tree.motion.carried(tree.rest[1:]) for tree in trees]
    shared = [np.zeros(X.shape[1], np.bool_) for X in carried]
    for a, b in permutations(range(len(trees)), 2):
        shared[a][[i for i, _ in same_joints(carried[a], carried[b], GATE * size)]] = True
    least = max(shared[0].sum(), 1)
    scores = [has.sum() - (~has).sum() if has.sum() >= least else -np.inf for has in shared]
    which = int(np.argmax(scores))
    chosen = AgreeingCut(which, trees[which], [cut.beside(trees[which]) for cut in joints])
    if which:
        chosen.further[which - 1] = carried[0]
    return chosen


def first_cut(first: FirstTree, joints: Sequence[CutJoints]) -> AgreeingCut:
    """The first cut, whatever the others say."""
    return AgreeingCut(0, first, [cut.beside(first) for cut in joints])
