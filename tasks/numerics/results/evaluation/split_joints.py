"""Joints at which more than two bones turn independently of each other.

A joint usually carries all its children as one rigid group. Where it does not, as at the hips of a rig made of single bones,
one place holds several joints, and a method that finds all of them has found nothing spurious.
"""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import networkx as nx
import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.results.evaluation.settings import EvaluationSettings


class SplitTree(NamedTuple):
    """A tree in which every joint carries one rigid group; given joints keep their numbers, added ones follow.

    origin  : (joint,) the joint of the given tree at the same place
    parents : (joint,) parent of every joint, −1 for the root
    scored  : (joint,) whether the result should have it; a scored root hands its score on to the first joint added to it
    """

    origin: Ints
    parents: list[int]
    scored: Flags


def split_joints(
    Y: Floats, parents: Sequence[int], scored: Sequence[bool], height: float, settings: EvaluationSettings | None = None
) -> SplitTree:
    """Adds a joint at the same place for every rigid group of a joint's children but the first (ours).

    The parent of an added joint is the parent of the joint at its place; where that is the root, it is the root itself.

    Y        : (frame, joint, xyz) true positions, mesh unit
    parents  : (joint,) parent of every joint of the given tree, −1 for the root
    scored   : (joint,) whether the result should have it
    height   : of the body, mesh unit
    settings : rigid_deviation is used
    """
    above, is_scored, origin = list(parents), list(scored), list(range(len(parents)))
    deviation = (settings or EvaluationSettings()).rigid_deviation * height
    for j in _parents_first(parents):
        parent_of_added = above[j] if parents[j] >= 0 else j
        for group in rigid_groups(Y, [c for c, q in enumerate(parents) if q == j], deviation)[1:]:
            if parents[j] < 0 and is_scored[j]:
                is_scored[j] = False
                is_scored.append(True)
            else:
                is_scored.append(False)
            origin.append(j)
            above.append(parent_of_added)
            for c in group:
                above[c] = len(origin) - 1
    return SplitTree(np.array(origin, dtype=np.int64), above, np.array(is_scored, dtype=bool))


def rigid_groups(Y: Floats, children: Sequence[int], deviation: float) -> list[list[int]]:
    """Children of one joint in groups whose members keep their distances: linked by pairs whose distance stays the same.

    Y         : (frame, joint, xyz) mesh unit
    children  : joints, as numbers of Y
    deviation : largest standard deviation over the frames of a distance that stays the same, mesh unit
    returns   : the groups, each ascending, in the order of their first child
    """
    rigid: nx.Graph[int] = nx.Graph()
    rigid.add_nodes_from(children)
    for a, b in itertools.combinations(children, 2):
        if np.linalg.norm(Y[:, a] - Y[:, b], axis=1).std() <= deviation:
            rigid.add_edge(a, b)
    return [sorted(group) for group in nx.connected_components(rigid)]


def _parents_first(parents: Sequence[int]) -> list[int]:
    """All joints, each after its parent."""
    order = [j for j, p in enumerate(parents) if p < 0]
    for j in order:
        order.extend(c for c, p in enumerate(parents) if p == j)
    return order
