"""Clusters of nodes that move as one rigid body (2009, Sec. 2.3.1, Eqs. 5, 6; Fig. 2), or by what each is needed for (ours)."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.structure.elimination import EliminationSettings, NormalisedBody, eliminated
from kinetree.tasks.numerics.structure.part_labels import relabelled
from kinetree.tasks.numerics.structure.part_motion import fit, misfit, residuals
from kinetree.tasks.numerics.structure.score_spans import score_spans

ELIMINATIONS = 2
"""Eliminations, each followed by a round of labels and motions, as for the default method's rigid parts."""
LABEL_ROUNDS = 3
"""Rounds of neighbours whose motion decides with a vertex. Not recorded."""


class PartMotions(NamedTuple):
    """How rigid parts move; x(t) ≈ R v + t.

    label    : (vertex,) part, numbered from 0
    R, t     : (frame, part, 3, 3) · (frame, part, xyz) mesh unit
    residual : (frame, part) root mean square of what the motion leaves, mesh unit
    """

    label: Ints
    R: Floats
    t: Floats
    residual: Floats


def velocity_correlation(X: Floats, pair: Ints, *, relative: bool = True, one_too_few: bool = False) -> Floats:
    """(pair,) cross-correlation r(i, j) of the velocities of two nodes over an interval  (Eqs. 5, 6).

    X           : (frame, node, xyz) mesh unit · pair : (pair, 2)
    relative    : whether the mean velocity of all nodes is taken out; with it a walker's nodes all correlate
    one_too_few : whether the mean divides by t_e − t_b, as Eq. 6 has it, and not by the number of velocities
    returns     : −1 to 1 (more where the mean divides by one too few); 1 for a pair of which one does not move
    """
    v = np.diff(X, axis=0)
    if relative:
        v = v - v.mean(axis=1, keepdims=True)
    terms = max(len(v) - 1, 1) if one_too_few else max(len(v), 1)
    d = v - v.sum(axis=0) / terms
    norm = np.sqrt((d**2).sum(axis=(0, 2)))
    a, b = pair[:, 0], pair[:, 1]
    product = norm[a] * norm[b]
    r = np.einsum("tpx,tpx->p", d[:, a], d[:, b]) / np.where(product > 0.0, product, 1.0)
    return np.where(product > 0.0, r, 1.0)


def correlated_clusters(parents: Ints, r: Floats, threshold: float) -> Ints:
    """(node,) cluster, numbered from 0: a node is of its parent's where their velocities correlate at least so much.

    parents : (node,) parents first · r : (node − 1,) of every node but the first with its parent
    """
    cluster = np.zeros(len(parents), np.int64)
    count = 1
    for n in range(1, len(parents)):
        together = r[n - 1] >= threshold
        cluster[n] = cluster[parents[n]] if together else count
        count += not together
    return cluster


def rigid_clusters(
    V: Floats, F: npt.NDArray[np.integer[Any]], x: Floats, confidence: Floats, area: Floats, label: Ints, removal_cost: float
) -> Ints:
    """(vertex,) part, numbered from 0: nodes without which the motion is explained as well go with their neighbours (ours).

    V, F       : (vertex, xyz) mesh unit · (face, corner)
    x          : (frame, vertex, xyz) mesh unit · confidence : (frame, vertex) 0 to 1 · area : (vertex,) mesh unit²
    label      : (vertex,) node that carries it
    removal_cost : motion left unexplained from which on a node stays, share of the root of the area
    """
    size, shift = float(np.sqrt(area.sum())), x.mean(axis=1, keepdims=True)
    X = np.ascontiguousarray((x - shift) / size)
    Q = (V - area @ V / area.sum()) / size
    faces = np.array(F, np.int64)
    N, spans = vertex_normals(V, F), score_spans(len(x), None)
    body = NormalisedBody(Q, N, faces, X, confidence, area / size**2, *rings(faces, len(V)), spans)
    limits = EliminationSettings(removal_cost=removal_cost)
    label, R, t = _fitted(Q, X, confidence, body.area, label, limits.floor)
    for _ in range(ELIMINATIONS):
        merged = eliminated(body, label, R, t, limits)
        label = relabelled(Q, X, confidence, merged.R, merged.t, merged.label, body.start, body.ring, LABEL_ROUNDS)
        label, R, t = _fitted(Q, X, confidence, body.area, label, limits.floor)
    return label


def part_motions(V: Floats, x: Floats, confidence: Floats, area: Floats, label: Ints, removal_cost: float) -> PartMotions:
    """The rigid motions of labelled parts, from their clearly rigid vertices; arrays as in `rigid_clusters`."""
    label, R, t = _fitted(V, x, confidence, area, label, 1e-10 * float(area.sum()))
    scale = removal_cost**2 * float(area.sum())
    rigid = scale / (scale + 4.0 * misfit(V, x, confidence, R, t, label))
    return PartMotions(label, R, t, residuals(V, x, confidence * area * rigid, R, t, label))


def _fitted(V: Floats, x: Floats, weight: Floats, area: Floats, label: Ints, floor: float) -> tuple[Ints, Floats, Floats]:
    """(vertex,) labels without gaps · motions of the parts."""
    used, label = np.unique(label, return_inverse=True)
    label = label.reshape(-1).astype(np.int64)
    R, t = np.empty((len(x), len(used), 3, 3)), np.empty((len(x), len(used), 3))
    fit(V, x, weight, area, label, np.ones(len(used), np.bool_), False, len(label), floor, R, t)
    return label, R, t
