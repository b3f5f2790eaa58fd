"""A tube as a trunk: a joint amid it that no cut has found, a part above, and two limbs side by side below."""

import numpy as np
from articulated import chain
from smeared import END, moving

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.structure.first_tree import FirstTree, PartGraph
from kinetree.tasks.numerics.structure.part_tree import MovingSurface

LIMBS = -3.2
"""Height below which the tube is two limbs; the joint that is found is at `END`, one that is not at 0, or others."""
MIRRORED = (2, 3)


def trunk(
    turn: Floats, root: int = 0, place: float = 1.5, hidden: tuple[float, ...] = (0.0,)
) -> tuple[MovingSurface, FirstTree]:
    """The tube aligned as it is, and its tree: the trunk is part 0, the one above 1, limbs are 2 and 3.

    turn : (frame, part, 3, 3) of the true parts
    root : 0; with 1 the part above is part 0 and the root, the trunk part 1
    place : height of the trunk's joint where it is the root
    hidden : heights of the joints that are not found
    """
    body = chain((*hidden, END), turn, along=60)
    z, right = body.V[:, 2], body.V[:, 0] > 0.0
    label = np.where(z > END, 1, np.where(z >= LIMBS, 0, np.where(right, 2, 3)))
    label = np.array([root, 1 - root, 2, 3])[label]
    moved = [[rigid_motion(body.V[label == p], x[label == p], np.ones((label == p).sum())) for p in range(4)] for x in body.x]
    R, t = (np.array([[one[k] for one in frame] for frame in moved]) for k in (0, 1))
    aside = [[0.5, 0.0, LIMBS], [-0.5, 0.0, LIMBS]]
    rest = np.array([[0.0, 0.0, place if root == 0 else 4.0], [0.0, 0.0, END], *aside])
    none = np.zeros(0)
    graph = PartGraph(label, np.zeros((0, 2), np.int64), np.zeros((0, 3)), none, none, ())
    frames = len(turn)
    tree = FirstTree(
        parents=np.array([-1, 0, root, root]), place=np.arange(4), shown=(), label=label, W=np.eye(4)[label], R=R, t=t,
        certain_share=np.ones((frames, 4)), rest=rest, drift=np.zeros(4), unexplained=np.full((frames, 4), 0.01),
        radius=np.array([0.0, 1.0, 0.5, 0.5]), end_x=np.zeros((frames, 0, 3)), graph=graph,
    )  # fmt: skip
    return moving(body), tree
