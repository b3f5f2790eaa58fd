"""Two legs of which one thigh or both hold flesh of pelvis and chest."""

import numpy as np
from legs import ALONG, FRAMES, HIP, LEAVES, LEGS, Legs, V, of_legs
from shipped import TREE

from kinetree.tasks.numerics.arrays import Flags
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.limbs_apart import moving_by_themselves
from kinetree.tasks.numerics.structure.part_tree import MovingSurface, part_tree
from kinetree.tasks.numerics.structure.pruning import Pruned
from kinetree.tasks.numerics.structure.tree_joints import tree_of_parts

ONES = np.ones((FRAMES, len(V)))
OUTSIDE = {side: V @ np.array([0.0, np.sign(leg[1]), 0.0]) for side, leg in LEGS.items()}


def flesh_of(side: str) -> Flags:
    """(vertex,) the side of pelvis and chest that one leg's thigh holds."""
    return np.asarray((ALONG[side] <= HIP) & (OUTSIDE[side] > 0.0) & (V[:, 0] < 10.0))


def seen(*sides: str, parts: dict[str, int] | None = None) -> tuple[MovingSurface, FirstTree]:
    """The legs as a cut has them, with flesh of the trunk in the thighs of these sides."""
    legs = Legs.of(parts)
    label = legs.parts.label.copy()
    for side in sides:
        label[flesh_of(side)] = legs.parts.label[np.argmin(np.abs(ALONG[side] - 10.0))]
    count = int(label.max()) + 1
    moved = moving_by_themselves(legs.body, legs.parts._replace(label=label), range(count), ONES)
    found = part_tree(legs.body, moved)
    left = Pruned(moved, found, found, np.arange(count), ())
    return legs.body, in_tree_order(tree_of_parts(legs.body, left, np.arange(count), label, ONES, TREE), count)


def pairs() -> LimbPairs:
    """Both legs; twice, since a single pair of limbs says nothing of a body."""
    return LimbPairs(*(np.concatenate([a, a]) for a in of_legs()))


def rooted(tree: FirstTree) -> RootedParts:
    return RootedParts(tree.label, tree.parents, tree.radius)


def thigh(tree: FirstTree, side: str) -> int:
    """The part of what lies amid a thigh."""
    return int(tree.label[np.argmin(np.abs(ALONG[side] - 10.0))])


def hips(tree: FirstTree) -> list[float]:
    """How far the joint of each thigh is from its true place."""
    return [float(np.linalg.norm(tree.rest[thigh(tree, side)] - HIP * leg)) for side, leg in LEGS.items()]


def ends(tree: FirstTree) -> set[frozenset[int]]:
    """What each joint joins, by vertices amid thighs and at the ends of legs and chest; −1 for the pelvis."""
    places = {int(tree.label[v]): v for v in (*(int(np.argmin(np.abs(along - 10.0))) for along in ALONG.values()), *LEAVES[:3])}
    number = [places.get(part, -1) for part in range(len(tree.parents))]
    return {frozenset((number[k], number[int(tree.parents[k])])) for k in range(1, len(tree.parents))}
