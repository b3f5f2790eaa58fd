"""What a vertex sees over a surface: straight lines that leave it, unfolded from triangle to triangle (2014, Sec. 4).

A window is a range of directions. One leaves the vertex through every face around it and crosses triangle after triangle,
unfolded into the plane of the first. The third vertex of a triangle splits it in two; a window that has become narrow is
dropped, since the vertices on both sides of it serve its directions. So the lines are about equally dense in all directions,
whatever the sizes of the triangles.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Indices, Lengths
from kinetree.tasks.numerics.compiled import compiled

Rings = tuple[Indices, Indices, Indices, Indices, Indices, Lengths, Lengths]
FaceShapes = tuple[Floats, Floats, Lengths, Lengths]
Lines = tuple[Indices, Lengths, Lengths, Lengths]

BORDER = 0xFFFFFFFF
"""In place of a half-edge where the surface ends."""
NON_MANIFOLD = 0xFFFFFFFE
"""In place of a half-edge where the surface goes on, but not with one face."""
MAX_LINES = 192
"""Safety bound: lines of one vertex beyond its edges; 40 are usual."""
MAX_WINDOWS = 128
"""Safety bound: windows that wait while one is followed; each split adds one."""
_0, _1, _2, _3 = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(3)
_NON_MANIFOLD, _MAX_LINES, _MAX_WINDOWS = np.uint64(NON_MANIFOLD), np.uint64(MAX_LINES), np.uint64(MAX_WINDOWS)


@compiled
def after(h: np.uint64) -> np.uint64:
    """The next half-edge of the same face."""
    return h - _2 if h % _3 == _2 else h + _1


@compiled
def before(h: np.uint64) -> np.uint64:
    """The half-edge before it in the same face."""
    return h + _2 if h % _3 == _0 else h - _1


@compiled
def face_shapes(start: Indices, ring: Indices, ring_edge: Indices, angle: Floats, length: Lengths) -> tuple[FaceShapes, Floats]:
    """Directions around every vertex and the shape of every triangle, and the total angle of each vertex.

    turn  : (half-edge,) its direction at its tail, counted from the first of the ring
    along : (half-edge,) foot of the face's third vertex on it, and `above`, its height, as shares of its length
    """
    turn, total = np.zeros(len(angle)), np.zeros(len(start) - 1)
    for v in range(len(total)):
        for j in range(start[v], start[v + 1]):
            if ring[j] & 1:
                turn[ring_edge[j]] = total[v]
                total[v] += angle[ring_edge[j]]
    along, above = np.empty(len(angle), np.float32), np.empty(len(angle), np.float32)
    for h in range(np.uint64(len(angle))):
        a, b = after(np.uint64(h)), before(np.uint64(h))
        base, side, rim = np.float64(length[h]), np.float64(length[b]), np.float64(length[a])
        foot = 0.5 + 0.5 * (side - rim) * (side + rim) / (base * base) if base > 0.0 else 0.5
        along[h] = foot
        above[h] = np.sqrt(max(side * side / (base * base) - foot * foot, 0.0)) if base > 0.0 else 0.0
    return (turn, angle, along, above), total


@compiled
def append_edges(v: np.uint64, rings: Rings, shape: FaceShapes, place: Indices, first: np.uint64, lines: Lines) -> np.uint64:
    """Appends the edges of vertex v to the lines.

    v, rings, shape : as in `append_visible`
    place   : (vertex,) place + 1 of the last line to each vertex
    first   : where the lines of vertex v begin
    returns : how many lines there are then
    """
    start, ring, ring_edge, apex, twin, length, _ = rings
    turn, angle, _, _ = shape
    k = first
    for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
        if np.uint64(ring[j]) & _1 == _0:
            continue
        h = np.uint64(ring_edge[j])
        a, b = after(h), before(h)
        k = _append_line(np.uint64(apex[b]), length[h], turn[h], turn[a] + angle[a], place, first, k, lines)
        if twin[b] >= _NON_MANIFOLD:
            k = _append_line(np.uint64(apex[h]), length[b], turn[h] + angle[h], turn[b], place, first, k, lines)
    return k


@compiled
def _append_line(
    c: np.uint64, far: float, leaving: float, arriving: float, place: Indices, first: np.uint64, k: np.uint64, lines: Lines
) -> np.uint64:
    """Keeps one line to each vertex, the shortest; returns how many lines there are then. `place` as in `append_edges`."""
    target, reach, out, back = lines
    i = np.uint64(place[c])
    if i <= first:
        i = k + _1
        place[c], target[k], reach[k] = i, c, np.inf
        k = i
    i -= _1
    if far < reach[i]:
        reach[i], out[i], back[i] = far, leaving, arriving
    return k


@compiled
def append_visible(
    v: np.uint64, limit: float, narrow: float, rings: Rings, shape: FaceShapes, place: Indices, first: np.uint64, k: np.uint64,
    lines: Lines, windows: Floats, crossing: Indices,
) -> np.uint64:  # fmt: skip
    """Appends the lines to what vertex v sees beyond its edges.

    v        : vertex in the surface's own numbering
    limit    : squared distance beyond which nothing is seen, mesh unit²
    narrow   : sine of the angle below which a window is dropped
    rings    : start, ring, ring_edge, apex, twin, length and ring_length of the surface
    shape    : see `face_shapes`
    place    : (vertex,) place + 1 of the last line to each vertex
    first, k : where the lines of vertex v begin · how many lines there are
    lines    : target, length, direction at v and direction at the target; written
    windows, crossing : memory for the windows that wait
    returns  : how many lines there are then
    """
    start, ring, ring_edge, apex, twin, length, _ = rings
    turn, angle, along, above = shape
    full = k + _MAX_LINES
    for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
        if np.uint64(ring[j]) & _1 == _0:
            continue
        h = np.uint64(ring_edge[j])
        origin = turn[h]
        lx, ly, rx, ry, bx, by = np.cos(angle[h]), np.sin(angle[h]), 1.0, 0.0, np.float64(length[h]), 0.0
        ax, ay = lx * length[before(h)], ly * length[before(h)]
        h, top, followed = np.uint64(twin[after(h)]), _0, ly > narrow or lx < 0.0
        while followed:
            ex, ey = bx - ax, by - ay
            followed = False
            if h < _NON_MANIFOLD and (ax * ey - ay * ex) ** 2 <= limit * (ex * ex + ey * ey):
                b = before(h)
                cx, cy = ax + ex * along[h] - ey * above[h], ay + ey * along[h] + ex * above[h]
                if cx * ly < cy * lx:
                    h, ax, ay, followed = np.uint64(twin[after(h)]), cx, cy, True
                elif rx * cy < ry * cx:
                    h, bx, by, followed = np.uint64(twin[b]), cx, cy, True
                elif cx * cx + cy * cy <= limit and k < full:
                    c, far = np.uint64(apex[h]), np.sqrt(cx * cx + cy * cy)
                    if c != v:
                        leaving, x, y = origin + direction(cx, cy), ax - cx, ay - cy
                        k = _append_line(
                            c, far, leaving, turn[b] + direction(-x * cx - y * cy, y * cx - x * cy), place, first, k, lines
                        )
                    mx, my = cx / far, cy / far
                    if mx * ly - my * lx > narrow or mx * lx + my * ly < 0.0:
                        w = windows[top]
                        w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7] = ax, ay, cx, cy, lx, ly, mx, my
                        crossing[top] = twin[b]
                        top += np.uint64(top < _MAX_WINDOWS - _1)
                    if rx * my - ry * mx > narrow or mx * rx + my * ry < 0.0:
                        h, ax, ay, lx, ly, followed = np.uint64(twin[after(h)]), cx, cy, mx, my, True
            if not followed and top > _0:
                top -= _1
                w, h, followed = windows[top], np.uint64(crossing[top]), True
                ax, ay, bx, by, lx, ly, rx, ry = w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7]
    return k


@compiled
def direction(x: float, y: float) -> float:
    """Angle of (x, y) from the x axis, from 0 to π for y ≥ 0, within 0.001: an odd polynomial, faster than arctan2."""
    u, w = abs(x), max(y, 0.0)
    less, more = min(u, w), max(u, w)
    t = less / more if more > 0.0 else 0.0
    a = t * (0.99535 + t * t * (0.07934 * t * t - 0.28869))
    a = 0.5 * np.pi - a if w > u else a
    return np.pi - a if x < 0.0 else a
