"""One kinematic structure from those of all intervals: of each branch the most detailed (2009, Sec. 2.4, Fig. 3).

A branch is cut where its clusters meet. Cuts are carried from one structure to another as shares of the branch's length from
its leaf, which motion does not change.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


class Piecewise(NamedTuple):
    """The structure of one interval.

    node    : (node, xyz) mesh unit · parents : (node,) · branch : (node,) · end : (leaf,) see `graph_body.GraphBody`
    track   : (leaf,) the limb that each leaf is, the same in all intervals; −1 where it is none that was followed
    cluster : (node,)
    """

    node: Floats
    parents: Ints
    branch: Ints
    end: Ints
    track: Ints
    cluster: Ints


class Integrated(NamedTuple):
    """The integrated structure.

    base    : the structure whose nodes it has
    source  : (leaf of the base,) the structure that each branch's clusters are from
    cluster : (node of the base,) numbered from 0
    """

    base: int
    source: Ints
    cluster: Ints


def integrated_structure(structures: Sequence[Piecewise]) -> Integrated:
    """The structure with most clusters, each branch cut as in the structure that cuts it most often.

    structures : at least one; of several equals the first counts
    """
    detail = [len(np.unique(s.cluster)) for s in structures]
    base = int(np.argmax(detail))
    own = structures[base]
    cluster = own.cluster.copy()
    source = np.full(len(own.end), base)
    for leaf, track in enumerate(own.track.tolist()):
        cuts = branch_cuts(own, leaf)
        for number, other in enumerate(structures):
            rows = np.flatnonzero(other.track == track).tolist() if track >= 0 else []
            theirs = branch_cuts(other, rows[0]) if rows and number != base else []
            if len(theirs) > len(cuts):
                cuts, source[leaf] = theirs, number
        if source[leaf] != base:
            cluster = _cut(own, cluster, leaf, cuts)
    return Integrated(base, source, np.unique(cluster, return_inverse=True)[1].reshape(-1).astype(np.int64))


def branch_nodes(structure: Piecewise, leaf: int) -> tuple[list[int], Floats]:
    """Nodes of a branch from its leaf inwards, and the first beyond it · their distance from the leaf by its length."""
    n = int(structure.end[leaf])
    way = [n]
    while structure.branch[n] == leaf and structure.parents[n] >= 0:
        n = int(structure.parents[n])
        way.append(n)
    far = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(structure.node[way], axis=0), axis=1))])
    return way, far / max(float(far[-1]), np.finfo(float).tiny)


def branch_cuts(structure: Piecewise, leaf: int) -> list[float]:
    """Where clusters meet along a branch, shares of its length from the leaf."""
    way, far = branch_nodes(structure, leaf)
    own = structure.cluster[way]
    return [float(far[k] + far[k + 1]) / 2 for k in range(len(way) - 1) if own[k] != own[k + 1]]


def _cut(structure: Piecewise, cluster: Ints, leaf: int, cuts: list[float]) -> Ints:
    """(node,) clusters with one branch cut anew."""
    way, far = branch_nodes(structure, leaf)
    out = cluster.copy()
    piece = np.searchsorted(np.array(cuts), far)
    new = int(cluster.max()) + 1 + piece
    on = np.array([structure.branch[n] == leaf for n in way])
    attached = piece == piece[-1]
    new[attached] = cluster[way[-1]]
    out[np.array(way)[on]] = new[on]
    return out
