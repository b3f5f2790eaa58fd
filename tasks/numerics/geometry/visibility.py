"""What a vertex sees over a surface: the straight lines that leave it, unfolded into the plane (2014, Sec. 4).

Light leaves a vertex through every face around it and goes straight from triangle to triangle. A vertex that it meets
splits it in two, and what has become narrow is not followed further: the vertices on both sides of it serve its direction.
So the lines lie about equally dense in all directions, whatever the sizes of the triangles.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Indices, Lengths
from kinetree.tasks.numerics.compiled import compiled

Rings = tuple[Indices, Indices, Indices, Indices, Indices, Lengths, Lengths]
Corners = tuple[Floats, Floats, Lengths, Lengths]
Found = tuple[Indices, Lengths, Lengths, Lengths]

NONE = 0xFFFFFFFF  # no half-edge: a border
BLIND = 0xFFFFFFFE  # no half-edge either, though the surface goes on
MOST = 192  # lines of one vertex beyond its edges
DEPTH = 128  # windows that wait while one is followed: half of them at each split, so 1 in 2^128 is lost
_0, _1, _2, _3 = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(3)
_BLIND, _MOST, _DEPTH = np.uint64(BLIND), np.uint64(MOST), np.uint64(DEPTH)


@compiled
def after(h: np.uint64) -> np.uint64:
    """The next half-edge of the same face."""
    return h - _2 if h % _3 == _2 else h + _1


@compiled
def before(h: np.uint64) -> np.uint64:
    """The half-edge before it in the same face."""
    return h + _2 if h % _3 == _0 else h - _1


@compiled
def corners(start: Indices, ring: Indices, ring_edge: Indices, angle: Floats, length: Lengths) -> tuple[Corners, Floats]:
    """Directions around every vertex and the shape of every triangle; the total angle of each vertex.

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
def edges_of(v: np.uint64, rings: Rings, shape: Corners, seen: Indices, first: np.uint64, found: Found) -> np.uint64:
    """Append the edges of vertex v to what is found; how much there is then."""
    start, ring, ring_edge, apex, twin, length, _ = rings
    turn, angle, _, _ = shape
    k = first
    for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
        if np.uint64(ring[j]) & _1 == _0:
            continue
        h = np.uint64(ring_edge[j])
        a, b = after(h), before(h)
        k = _keep(np.uint64(apex[b]), length[h], turn[h], turn[a] + angle[a], seen, first, k, found)
        if twin[b] >= _BLIND:
            k = _keep(np.uint64(apex[h]), length[b], turn[h] + angle[h], turn[b], seen, first, k, found)
    return k


@compiled
def _keep(
    c: np.uint64, far: float, leaving: float, arriving: float, seen: Indices, first: np.uint64, k: np.uint64, found: Found
) -> np.uint64:
    """One line per vertex, the shortest: `seen` holds its place + 1, if it is one of this vertex's."""
    target, reach, out, back = found
    i = np.uint64(seen[c])
    if i <= first:
        i = k + _1
        seen[c], target[k], reach[k] = i, c, np.inf
        k = i
    i -= _1
    if far < reach[i]:
        reach[i], out[i], back[i] = far, leaving, arriving
    return k


@compiled
def shine(
    v: np.uint64, limit: float, narrow: float, rings: Rings, shape: Corners, seen: Indices, first: np.uint64, k: np.uint64,
    found: Found, windows: Floats, crossing: Indices,
) -> np.uint64:  # fmt: skip
    """Append what vertex v sees beyond its edges; how much there is then.

    limit  : squared distance at which light ends
    narrow : sine of the angle below which light is not followed
    """
    start, ring, ring_edge, apex, twin, length, _ = rings
    turn, angle, along, above = shape
    full = k + _MOST
    for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
        if np.uint64(ring[j]) & _1 == _0:
            continue
        h = np.uint64(ring_edge[j])
        origin = turn[h]
        lx, ly, rx, ry, bx, by = np.cos(angle[h]), np.sin(angle[h]), 1.0, 0.0, np.float64(length[h]), 0.0
        ax, ay = lx * length[before(h)], ly * length[before(h)]
        h, top, lit = np.uint64(twin[after(h)]), _0, ly > narrow or lx < 0.0
        while lit:
            ex, ey = bx - ax, by - ay
            lit = False
            if h < _BLIND and (ax * ey - ay * ex) ** 2 <= limit * (ex * ex + ey * ey):
                b = before(h)
                cx, cy = ax + ex * along[h] - ey * above[h], ay + ey * along[h] + ex * above[h]
                if cx * ly < cy * lx:
                    h, ax, ay, lit = np.uint64(twin[after(h)]), cx, cy, True
                elif rx * cy < ry * cx:
                    h, bx, by, lit = np.uint64(twin[b]), cx, cy, True
                elif cx * cx + cy * cy <= limit and k < full:
                    c, far = np.uint64(apex[h]), np.sqrt(cx * cx + cy * cy)
                    if c != v:
                        leaving, x, y = origin + direction(cx, cy), ax - cx, ay - cy
                        k = _keep(
                            c, far, leaving, turn[b] + direction(-x * cx - y * cy, y * cx - x * cy), seen, first, k, found
                        )
                    mx, my = cx / far, cy / far
                    if mx * ly - my * lx > narrow or mx * lx + my * ly < 0.0:
                        w = windows[top]
                        w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7] = ax, ay, cx, cy, lx, ly, mx, my
                        crossing[top] = twin[b]
                        top += np.uint64(top < _DEPTH - _1)
                    if rx * my - ry * mx > narrow or mx * rx + my * ry < 0.0:
                        h, ax, ay, lx, ly, lit = np.uint64(twin[after(h)]), cx, cy, mx, my, True
            if not lit and top > _0:
                top -= _1
                w, h, lit = windows[top], np.uint64(crossing[top]), True
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
