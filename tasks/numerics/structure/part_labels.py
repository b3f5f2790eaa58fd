"""Which part each vertex follows: the one whose motion is nearest to its surroundings' motion, each part connected (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.structure.part_motion import squared_distance


@compiled
def relabelled(
    V: Floats, x: Floats, weight: Floats, R: Floats, t: Floats, label: Ints, start: Ints, ring: Ints, steps: int
) -> Ints:
    """Every vertex labelled with the part, of its own and those next to it, of the least mean residual around the vertex.

    V, x        : (vertex, xyz) · (frame, vertex, xyz) mesh unit
    weight      : (frame, vertex) confidence, 0 to 1
    R, t        : (frame, part, 3, 3) · (frame, part, xyz)
    label       : (vertex,) part before
    start, ring : neighbours of every vertex, see `neighbours.rings`
    steps       : means over a vertex and its neighbours that residuals go through: how far the surroundings reach
    returns     : (vertex,) part; vertices cut off from the bulk of their part go to the parts around them
    """
    parts = R.shape[1]
    near = border_edges(label, parts, start, ring)
    E = _misfits(V, x, weight, R, t, label, near)
    other = np.empty_like(E)
    for _ in range(steps):
        for v in range(len(E)):
            for p in range(parts):
                total = E[v, p]
                for q in range(start[v], start[v + 1]):
                    total += E[ring[q], p]
                other[v, p] = total / (1 + start[v + 1] - start[v])
        E, other = other, E
    best = np.zeros(len(label), np.int64)
    for v in range(len(label)):
        for p in range(1, parts):
            if E[v, p] < E[v, best[v]]:
                best[v] = p
    return connected(best, parts, start, ring)


@compiled
def border_edges(label: Ints, parts: int, start: Ints, ring: Ints) -> Ints:
    """(part, part) edges of the mesh between any two parts, each counted once from either side.

    label       : (vertex,) part, below `parts`
    start, ring : neighbours of every vertex, see `neighbours.rings`
    """
    near = np.zeros((parts, parts), np.int64)
    for v in range(len(label)):
        for q in range(start[v], start[v + 1]):
            if label[v] != label[ring[q]]:
                near[label[v], label[ring[q]]] += 1
    return near


@compiled
def connected(label: Ints, parts: int, start: Ints, ring: Ints) -> Ints:
    """Every part reduced to its largest connected piece, the rest given to the labels around it, nearest first.

    label       : (vertex,) part, below `parts`
    start, ring : neighbours of every vertex, see `neighbours.rings`
    returns     : (vertex,) part; a piece with no other label around it keeps its own
    """
    piece = np.full(len(label), -1, np.int64)
    stack = np.empty(len(label), np.int64)
    largest, winner = np.zeros(parts, np.int64), np.full(parts, -1, np.int64)
    pieces = 0
    for seed in range(len(label)):
        if piece[seed] >= 0:
            continue
        size = _flooded(label, seed, pieces, start, ring, piece, stack)
        if size > largest[label[seed]]:
            largest[label[seed]] = size
            winner[label[seed]] = pieces
        pieces += 1
    out = np.full(len(label), -1, np.int64)
    count = done = 0
    for v in range(len(label)):
        if piece[v] == winner[label[v]]:
            out[v] = label[v]
            stack[count] = v
            count += 1
    while done < count:
        v = stack[done]
        done += 1
        for q in range(start[v], start[v + 1]):
            if out[ring[q]] < 0:
                out[ring[q]] = out[v]
                stack[count] = ring[q]
                count += 1
    for v in range(len(label)):
        if out[v] < 0:
            out[v] = label[v]
    return out


@compiled
def _flooded(label: Ints, seed: int, number: int, start: Ints, ring: Ints, piece: Ints, stack: Ints) -> int:
    """Numbers the connected piece of a label around a vertex; returns how many vertices it has."""
    top, size = 1, 0
    stack[0] = seed
    piece[seed] = number
    while top:
        top -= 1
        v = stack[top]
        size += 1
        for q in range(start[v], start[v + 1]):
            u = ring[q]
            if piece[u] < 0 and label[u] == label[seed]:
                piece[u] = number
                stack[top] = u
                top += 1
    return size


@compiled
def _misfits(V: Floats, x: Floats, weight: Floats, R: Floats, t: Floats, label: Ints, near: Ints) -> Floats:
    """(vertex, part) mean squared residual under a vertex's own part and those next to it; far larger under all others."""
    parts = len(near)
    E = np.full((len(label), parts), -1.0)
    away = 0.0
    for v in range(len(label)):
        mass = 1e-6
        for f in range(x.shape[0]):
            mass += weight[f, v]
        for p in range(parts):
            if p == label[v] or near[label[v], p] > 0:
                total = 0.0
                for f in range(x.shape[0]):
                    total += weight[f, v] * squared_distance(V, x, R, t, v, f, p)
                E[v, p] = total / mass
                away = max(away, E[v, p])
    for v in range(len(label)):
        for p in range(parts):
            if E[v, p] < 0.0:
                E[v, p] = 4.0 * away
    return E
