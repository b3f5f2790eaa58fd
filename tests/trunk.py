"""A tube as a trunk: joints amid it that no cut has found, a part above, and two limbs side by side below."""

import numpy as np
from articulated import chain
from smeared import END, moving

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.structure.first_tree import FirstTree, PartGraph
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
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


def trunk_with_joint_midway(turn: Floats, hidden: tuple[float, ...]) -> tuple[MovingSurface, FirstTree]:
    """The tube as aligned, where a cut has one joint of the trunk, at height 0: its lower part is the root, its upper part 1.

    Limbs 2 and 3 hang side by side on the lower one; 4 and 5, and a head between them, 6, on the upper one, beyond `END`.
    """
    body = chain((*hidden, END), turn, along=60)
    x, y, z = body.V.T
    on_lower, on_upper = np.where(x < 0.0, 3, 2), np.where(y > 0.5, 6, np.where(x < 0.0, 5, 4))
    label = np.where(z > END, on_upper, np.where(z > 0.0, 1, np.where(z >= LIMBS, 0, on_lower)))
    moved = [[rigid_motion(body.V[label == p], x[label == p], np.ones((label == p).sum())) for p in range(7)] for x in body.x]
    R, t = (np.array([[one[k] for one in frame] for frame in moved]) for k in (0, 1))
    places = [(0.0, LIMBS / 2.0), (0.0, 0.0), (0.5, LIMBS), (-0.5, LIMBS), (0.5, END), (-0.5, END), (0.0, END)]
    none, frames = np.zeros(0), len(turn)
    tree = FirstTree(
        parents=np.array([-1, 0, 0, 0, 1, 1, 1]), place=np.arange(7), shown=(), label=label, W=np.eye(7)[label], R=R, t=t,
        certain_share=np.ones((frames, 7)), rest=np.array([[x, 0.0, height] for x, height in places]), drift=np.zeros(7),
        unexplained=np.full((frames, 7), 0.01), radius=np.array([0.0, 1.0, *5 * [0.5]]), end_x=np.zeros((frames, 0, 3)),
        graph=PartGraph(label, np.zeros((0, 2), np.int64), np.zeros((0, 3)), none, none, ()),
    )  # fmt: skip
    return moving(body), tree


def two_pairs(body: MovingSurface) -> LimbPairs:
    """The ends of these limbs; how far the rest is from them is not known."""
    tips = [[int(np.argmin(np.linalg.norm(body.V - [x, 0.0, z], axis=1))) for x in (1.0, -1.0)] for z in (-4.8, 4.8)]
    return LimbPairs(np.array(tips), np.full((2, 2, len(body.V)), np.inf))


def trunk_with_two_joints(
    turn: Floats, hidden: tuple[float, ...], found: tuple[float, float]
) -> tuple[MovingSurface, FirstTree]:
    """The tube as aligned, where a cut has two joints of the trunk: parts 0, 1 and 2 from below, the lowest is the root.

    Limbs 3 and 4 hang side by side on the lowest; 5 and 6, and a head between them, 7, on the highest, beyond `END`.
    found : heights of these joints
    """
    body = chain((*hidden, END), turn, along=60)
    x, y, z = body.V.T
    on_lower, on_upper = np.where(x < 0.0, 4, 3), np.where(y > 0.5, 7, np.where(x < 0.0, 6, 5))
    label = np.where(z > END, on_upper, np.where(z < LIMBS, on_lower, np.searchsorted(found, z)))
    moved = [[rigid_motion(body.V[label == p], x[label == p], np.ones((label == p).sum())) for p in range(8)] for x in body.x]
    R, t = (np.array([[one[k] for one in frame] for frame in moved]) for k in (0, 1))
    places = [(0.0, LIMBS), *((0.0, z) for z in found), (0.5, LIMBS), (-0.5, LIMBS), (0.5, END), (-0.5, END), (0.0, END)]
    none, frames = np.zeros(0), len(turn)
    tree = FirstTree(
        parents=np.array([-1, 0, 1, 0, 0, 2, 2, 2]), place=np.arange(8), shown=(), label=label, W=np.eye(8)[label], R=R, t=t,
        certain_share=np.ones((frames, 8)), rest=np.array([[x, 0.0, height] for x, height in places]), drift=np.zeros(8),
        unexplained=np.full((frames, 8), 0.01), radius=np.array([0.0, 1.0, 1.0, *5 * [0.5]]), end_x=np.zeros((frames, 0, 3)),
        graph=PartGraph(label, np.zeros((0, 2), np.int64), np.zeros((0, 3)), none, none, ()),
    )  # fmt: skip
    return moving(body), tree


def with_joint_amid(two: FirstTree, shown: tuple[int, ...]) -> FirstTree:
    """Such a tree with one joint more of the trunk, amid its two: 1, 2 and 3 are the trunk's now, from below."""
    return two._replace(
        parents=np.array([-1, 0, 1, 2, 0, 0, 3, 3, 3]),
        rest=np.insert(two.rest, 2, two.rest[[1, 2]].mean(axis=0), axis=0),
        label=np.where(two.label > 1, two.label + 1, two.label),
        radius=np.insert(two.radius, 2, 1.0),
        shown=shown,
    )
