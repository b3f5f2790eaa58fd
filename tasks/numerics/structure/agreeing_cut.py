"""Whose tree is used: that of the first cut, or of another one if the other cuts, and its own limbs, agree with it more (ours).

Which joints a cut shows depends on where its rings and patches fall. A joint that two cuts have is likely one, a joint that one
cut has alone is likely flesh; of two cuts neither is in the majority. Where vertices were aligned all cuts err alike, so that
their agreement alone does not say: another cut's tree is used there only if limbs of some cut are mirror images of each other
more than those of the first, and if it is no worse than that cut.
"""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_consensus import GATE, same_joints

AHEAD = 2
"""With `symmetry`, another cut's score must exceed the first one's by more than this. With 0, 1 and 2 as many joints of 124
bodies are found, with 3 fewer."""


def agreeing_cut(trees: Sequence[FirstTree], size: float, symmetry: Sequence[int] | None = None) -> int:
    """The cut with most joints that another cut has too, less those that it has alone.

    Where the frames give the correspondence it has such a joint, and no fewer of them than the first cut, so that a cut which
    shows little never wins; of equals it is the first. Elsewhere `symmetry` is added, see `joint_partners`. Only if the best
    cut with more symmetry than the first is clearly better (`AHEAD`), another one is used: of those that are as good as that
    cut and no less symmetric than the first the one with fewest joints of its own, of equals the best. For halves of a pelvis
    are mirror images of each other, which counts as much as the joint between them, that no other cut has, counts against
    them. Of two cuts it is the first.

    trees    : of all cuts, in the reference, the first cut's first
    size     : root of the area, mesh unit
    symmetry : by cut; None where the frames give the correspondence
    returns  : 0 for the first one, k for the k-th of the others
    """
    if len(trees) < 3:
        return 0
    carried = [tree.motion.carried(tree.rest[1:]) for tree in trees]
    shared = [in_other_cuts(X, carried[:k] + carried[k + 1 :], size) for k, X in enumerate(carried)]
    score = np.array([2.0 * has.sum() - len(has) for has in shared])
    if symmetry is None:
        least = max(shared[0].sum(), 1)
        return int(np.argmax([one if has.sum() >= least else -np.inf for one, has in zip(score, shared, strict=True)]))
    score += symmetry
    more = np.array(symmetry) - symmetry[0]
    best = score[more > 0].max(initial=-np.inf)
    if best <= score[0] + AHEAD:
        return 0
    as_good = np.flatnonzero((score >= best) & (more >= 0))
    return min(as_good.tolist(), key=lambda k: (int((~shared[k]).sum()), -score[k]))


def in_other_cuts(X: Floats, others: Sequence[Floats], size: float) -> Flags:
    """(joint,) whether another cut has each joint of a cut.

    X, others : (frame, joint, xyz) · by other cut the same, mesh unit
    size      : root of the area, mesh unit
    """
    has = np.zeros(X.shape[1], np.bool_)
    for Y in others:
        has[[j for j, _ in same_joints(X, Y, GATE * size)]] = True
    return has
