"""Joints at which more than two bones move by themselves.

A joint usually carries all its children as one rigid piece. Where it does not, as at the hips of a rig that is made of bones,
one place holds several joints, and a method that finds them all has found nothing spurious.
"""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import networkx as nx
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]
STILL = 0.0005
"""Standard deviation of the distance between two children, share of the height, up to which they are one rigid piece.

Rigs keep such distances to a millionth; where bones part, opposite ones show it least, by a thousandth at 37°.
"""


class Divided(NamedTuple):
    """A tree in which every joint carries one rigid piece; the joints there were keep their numbers, new ones follow.

    origin  : (joint,) which joint of the given tree lies at the same place
    parents : (joint,) parent of every joint, −1 for the root
    scored  : (joint,) whether it should be found; a root that should hands this on to the first joint beside it
    """

    origin: Ints
    parents: list[int]
    scored: Bools


def divided(Y: Floats, parents: Sequence[int], scored: Sequence[bool], height: float) -> Divided:
    """Gives every rigid piece beyond a joint's first a joint of its own at the same place.

    It hangs where the joint itself hangs, or on the root where that is the joint.

    Y               : (frame, joint, xyz) true positions, mesh unit
    parents, scored : (joint,) of the tree as it is told
    height          : of the body, mesh unit
    """
    above, asked, origin = list(parents), list(scored), list(range(len(parents)))
    for j in _outwards(parents):
        hangs = above[j] if parents[j] >= 0 else j
        for piece in rigid_pieces(Y, [c for c, q in enumerate(parents) if q == j], STILL * height)[1:]:
            if parents[j] < 0 and asked[j]:
                asked[j] = False
                asked.append(True)
            else:
                asked.append(False)
            origin.append(j)
            above.append(hangs)
            for c in piece:
                above[c] = len(origin) - 1
    return Divided(np.array(origin, dtype=np.int64), above, np.array(asked, dtype=bool))


def rigid_pieces(Y: Floats, children: Sequence[int], still: float) -> list[list[int]]:
    """Children of one joint in groups, each of which keeps its distance from some other of its group; in their order.

    Y     : (frame, joint, xyz) mesh unit
    still : standard deviation over the frames up to which a distance stays, mesh unit
    """
    together: nx.Graph[int] = nx.Graph()
    together.add_nodes_from(children)
    for a, b in itertools.combinations(children, 2):
        if np.linalg.norm(Y[:, a] - Y[:, b], axis=1).std() <= still:
            together.add_edge(a, b)
    return [sorted(piece) for piece in nx.connected_components(together)]


def _outwards(parents: Sequence[int]) -> list[int]:
    """All joints, each after its parent."""
    order = [j for j, p in enumerate(parents) if p < 0]
    for j in order:
        order.extend(c for c, p in enumerate(parents) if p == j)
    return order
