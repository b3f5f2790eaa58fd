"""Exact distances around a source, by the light of windows and of the vertices at which paths bend.

Behind a vertex with more than a full turn of angle, or at a border, lies a shadow: no straight line enters it. Once that
vertex knows its own distance, it lights its shadow as a source of its own. Windows cost too much for a whole body; they
serve the neighbourhood of a source, where a fraction of an edge is a large part of the distance.
"""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.exact_windows import HalfEdges, Indices, Lengths, Plane, reach, shine, third
from kinetree.tasks.numerics.geometry.visibility import BLIND, NONE, after, before

TURNS = 64  # faces between the two sides of a path that bends; what lies behind more of them stays dark
_0, _1 = np.uint64(0), np.uint64(1)
_NONE, _BLIND = np.uint64(NONE), np.uint64(BLIND)


@compiled
def light(
    source: np.uint64, limit: float, step: float, start: Indices, ring: Indices, ring_edge: Indices,
    bends: npt.NDArray[np.uint8], links: HalfEdges, room: Plane,
) -> None:  # fmt: skip
    """Exact distances up to `limit` from one source, and upper bounds for whatever else its light meets.

    step  : vertices whose distances differ by less send their light on in any order, again if they turn out nearer
    links : the surface's apex, twin and length; start, ring, ring_edge and bends are the surface's too
    room  : its distances must all be infinite; what is found has lost its claim to be exact if met[-1] is not 0
    """
    distance, bend, arrival, _, passed, _, _, met = room
    met[0], met[-2], met[-1] = source, 1, 0
    distance[source], bend[source], arrival[source], passed[source] = 0.0, 0.0, _NONE, np.inf
    level = 0.0
    while level <= limit and level < np.inf:
        following, k = np.inf, _0
        while k < np.uint64(met[-2]):
            v = np.uint64(met[k])
            k += _1
            if distance[v] < passed[v]:
                if distance[v] > level + step:
                    following = min(following, distance[v])
                    continue
                passed[v] = distance[v]
                _send_on(v, limit, start, ring, ring_edge, bends, links, room)
                following = level
        level = following


@compiled
def _send_on(
    v: np.uint64, limit: float, start: Indices, ring: Indices, ring_edge: Indices, bends: npt.NDArray[np.uint8],
    links: HalfEdges, room: Plane,
) -> None:  # fmt: skip
    """Along the edges of vertex v, all around if it is the source, and into its shadow if it has one."""
    apex, _, length = links
    sigma, source = room[0][v], np.uint64(room[2][v]) == _NONE
    for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
        if np.uint64(ring[j]) & _1 == _0:
            continue
        h = np.uint64(ring_edge[j])
        a, b = after(h), before(h)
        head, side = np.uint64(apex[b]), np.float64(length[b])
        if sigma + length[h] < room[0][head]:
            x, y = third(a, length)
            reach(head, sigma + length[h], sigma, a, x, y, room)
        reach(np.uint64(apex[h]), sigma + side, sigma, b, side, 0.0, room)
        if source:
            cx, cy = third(h, length)
            shine(h, cx, cy, np.float64(length[h]), 0.0, sigma, limit, links, room)
    if bends[v] and not source:
        shade(v, limit, links, room)


@compiled
def shade(v: np.uint64, limit: float, links: HalfEdges, room: Plane) -> None:
    """Light the shadow behind vertex v: all that lies at more than half a turn from the path that arrives, on both sides."""
    _, twin, length = links
    sigma, first = room[0][v], np.uint64(room[2][v])
    end, ex, ey = _straight_on(v, twin, length, room)
    h, x, y, lit = first, room[3][v, 0], room[3][v, 1], False
    for turn in range(TURNS):
        cx, cy = third(h, length)
        rx, ry = np.float64(length[h]), 0.0
        if not lit and turn > 0 and y <= 0.0 and y * cx >= x * cy:
            lit, rx, ry = True, -x, -y
            if h == end and rx * ey <= ry * ex:
                return
        if lit:
            last = h == end
            shine(h, ex if last else cx, ey if last else cy, rx, ry, sigma, limit, links, room)
            if last:
                return
        c, s = cx / length[before(h)], cy / length[before(h)]
        x, y = c * x + s * y, c * y - s * x
        h = np.uint64(twin[before(h)])
        if h == first:
            return
        if h >= _BLIND:
            break
    # round the path met a border: the rest of the shadow, if there is one, reaches from the other side to the other border
    h, lx, ly = end, ex, ey
    while h < _BLIND:
        shine(h, lx, ly, np.float64(length[h]), 0.0, sigma, limit, links, room)
        h = np.uint64(twin[h])
        if h < _BLIND:
            h = after(h)
            lx, ly = third(h, length)


@compiled
def _straight_on(v: np.uint64, twin: Indices, length: Lengths, room: Plane) -> tuple[np.uint64, float, float]:
    """Half a turn clockwise from the path that arrives at v: half-edge of the face and direction in its frame, or NONE."""
    h, x, y = np.uint64(room[2][v]), room[3][v, 0], room[3][v, 1]
    for _ in range(TURNS):
        t = np.uint64(twin[h])
        if t >= _BLIND:
            break
        c, s = third(after(t), length)
        c, s = c / length[h], s / length[h]
        h, x, y = after(t), c * x - s * y, c * y + s * x
        if y <= 0.0 and y * c >= x * s:
            return h, -x, -y
    return _NONE, 0.0, 0.0
