"""End effectors: the leaves of the body, and the far end of every limb that has none (2014, Sec. 6.3)."""

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths, ring_edges, rings

AS_MANY = 0.1
"""Share of the frames, two at least, that show as many leaves as the reference's or more. A dance at a quarter of its rate has
0.17; a wolf from silhouettes with one false leaf has 0.05."""


def end_effectors(V: Floats, F: Ints, label: Ints, parents: Ints, leaves: Ints) -> Ints:
    """Where chains of bones end on the surface.

    Every leaf is an end effector. A part without a leaf and with no part below it ends where its surface is farthest, along
    its edges, from its border; a body of one part has no ends but its leaves.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    label   : (vertex,) part, parents : (part,) −1 for the root
    leaves  : (leaf,) vertices
    returns : (end, 2) part and vertex, by part, a part's most distant first
    """
    start, ring = rings(F, len(V))
    edge = ring_edges(start, ring)
    ends: list[tuple[int, int]] = []
    for part in range(len(parents)):
        tips = [int(v) for v in leaves if label[v] == part]
        bare = part > 0 and not (parents == part).any()
        far = from_border(V, edge, label, part) if bare or len(tips) > 1 else np.zeros(len(V))
        if bare and not tips:
            tips = [int(np.argmax(far))]
        ends += [(part, v) for v in sorted(tips, key=lambda v: (-far[v], *V[v]))]
    return np.array(ends, dtype=np.int64).reshape(-1, 2)


def leaf_vertices(V: Floats, positions: Floats, extrema: npt.NDArray[np.integer[Any]], at: int, counts: Flags) -> Ints:
    """Vertices of the reference at the leaves that are seen in its frame.

    In fast motion leaves are lost and found anew under other numbers, so that true ones count in no interval. So all that are
    seen are taken, unless hardly any other frame shows as many (`AS_MANY`): then one of them may be none, and those that count
    in an interval are taken alone.

    V         : (vertex, xyz) reference, mesh unit
    positions : (leaf, xyz) of the leaves in the reference's frame, mesh unit; NaN where a leaf is not seen
    extrema   : (leaf, frame) extremum of each frame that is the leaf, −1 where it is not seen
    at        : the reference's frame among them
    counts    : (interval, leaf) whether a leaf counts in an interval
    returns   : (seen leaf,) the nearest vertex to each
    """
    seen, shown = extrema[:, at] >= 0, (extrema >= 0).sum(axis=0)
    is_usual = (shown >= shown[at]).sum() >= max(2, AS_MANY * len(shown))
    points = positions[seen if is_usual else seen & counts.any(axis=0)]
    return np.asarray(KDTree(V).query(points)[1] if len(points) else [], dtype=np.int64).reshape(-1)


def from_border(V: Floats, edge: Ints, label: Ints, part: int) -> Floats:
    """(vertex,) distance along the part's own edges from its border, mesh unit; 0 elsewhere or where there is no path."""
    edge = edge[label[edge[:, 0]] == part]
    inside = label[edge[:, 1]] == part
    border = np.unique(edge[~inside, 0])
    edge = edge[inside]
    if not len(border):
        return np.where(label == part, np.linalg.norm(V - V[label == part].mean(axis=0), axis=1), 0.0)
    far = dijkstra(edge_lengths(V, edge), directed=False, indices=border, min_only=True)
    return np.where(np.isfinite(far), far, 0.0)
