"""Windows of light, unfolded from triangle to triangle in the plane of their source (Mitchell, Mount, Papadimitriou 1987).

A vertex that a window meets splits it in two. A window that a path through an end of its edge undercuts everywhere is
dropped (Xin, Wang 2009); nothing else trims it, which keeps it small and makes windows grow faster than the vertices
they meet: about as the square of the radius, and more where nothing is undercut.
"""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.visibility import BLIND, after, before

Floats = npt.NDArray[np.float64]
Lengths = npt.NDArray[np.float32]
Indices = npt.NDArray[np.uint32]
HalfEdges = tuple[Indices, Indices, Lengths]
Plane = tuple[Floats, Floats, Indices, Floats, Floats, Floats, Indices, Indices]

DEPTH = 1024  # windows that wait while one is followed: no more than vertices on its way
GRAZING = 1e-6  # of the length: what the float32 lengths leave undecided counts as lit and as worth following
_0, _1 = np.uint64(0), np.uint64(1)
_BLIND, _DEPTH = np.uint64(BLIND), np.uint64(DEPTH)


@compiled
def plane(vertices: int) -> Plane:
    """Memory for the light of one source: what it writes.

    distance : (vertex,) infinite where no light was
    bend     : (vertex,) distance of the last bend on the way
    arrival  : (vertex,) half-edge that leaves the vertex, in whose face the light arrived
    behind   : (vertex, xy) where it came from; the half-edge is the x axis and the face lies above it
    passed   : (vertex,) the distance with which its own light was last sent on
    windows  : (DEPTH, 8) and crossing (DEPTH,), those that wait
    met      : (vertex + 2,) vertices met, their number last but one, 1 last if light was lost at a blind edge
    """
    return (
        np.empty(vertices),
        np.empty(vertices),
        np.empty(vertices, np.uint32),
        np.empty((vertices, 2)),
        np.empty(vertices),
        np.empty((DEPTH, 8)),
        np.empty(DEPTH, np.uint32),
        np.zeros(vertices + 2, np.uint32),
    )


@compiled
def third(h: np.uint64, length: Lengths) -> tuple[float, float]:
    """The face's third vertex, where its half-edge is the x axis from 0 and the face lies above."""
    base, side, rim = np.float64(length[h]), np.float64(length[before(h)]), np.float64(length[after(h)])
    x = 0.5 * (base + (side - rim) * (side + rim) / base)
    return x, np.sqrt(max(side * side - x * x, 0.0))


@compiled
def reach(v: np.uint64, value: float, sigma: float, h: np.uint64, x: float, y: float, room: Plane) -> None:
    """Vertex v is no farther than `value` > 0, by light from (x, y) in the frame of half-edge h with a bend at `sigma`."""
    distance, bend, arrival, behind, passed, _, _, met = room
    if value < distance[v]:
        if distance[v] == np.inf:
            met[met[-2]] = v
            passed[v] = np.inf
            met[-2] += np.uint32(1)
        distance[v], bend[v], arrival[v], behind[v, 0], behind[v, 1] = value, sigma, h, x, y


@compiled
def shine(
    h: np.uint64, lx: float, ly: float, rx: float, ry: float, sigma: float, limit: float, links: HalfEdges, room: Plane
) -> None:
    """Follow the light of the vertex that h leaves, between two rays l and r, through the opposite edge of h's face.

    lx … ry : left and right ray, in the frame of h
    sigma   : distance of that vertex; the light is lost where it comes to more than `limit`
    links   : the surface's apex, twin and length
    """
    apex, twin, length = links
    distance, _, _, _, _, windows, crossing, met = room
    ax, ay = third(h, length)
    bx, by, h, top = np.float64(length[h]), 0.0, np.uint64(twin[after(h)]), _0
    while True:
        if h < _BLIND:
            a, b = after(h), before(h)
            x, y = third(h, length)
            ex, ey = (bx - ax) / length[h], (by - ay) / length[h]
            cx, cy, c = ax + ex * x - ey * y, ay + ey * x + ex * y, np.uint64(apex[h])
            from_left, from_right = cx * ly - cy * lx, rx * cy - ry * cx
            grazing = GRAZING * (abs(cx) + abs(cy))
            far = np.sqrt(cx * cx + cy * cy)
            if from_left >= -grazing * (abs(lx) + abs(ly)) and from_right >= -grazing * (abs(rx) + abs(ry)):
                ux, uy = (ax - cx) / length[b], (ay - cy) / length[b]
                reach(c, sigma + far, sigma, b, -cx * ux - cy * uy, cx * uy - cy * ux, room)
            mx, my = (cx, cy) if from_left >= 0.0 else (lx, ly)
            if from_right > 0.0 and _worth(cx, cy, bx, by, mx, my, rx, ry, sigma, limit, distance[c], distance[apex[b]]):
                w = windows[top]
                w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7] = cx, cy, bx, by, mx, my, rx, ry
                crossing[top] = twin[a]
                top += np.uint64(top < _DEPTH - _1)
            mx, my = (cx, cy) if from_right >= 0.0 else (rx, ry)
            if from_left > 0.0 and _worth(ax, ay, cx, cy, lx, ly, mx, my, sigma, limit, distance[apex[a]], distance[c]):
                h, bx, by, rx, ry = np.uint64(twin[b]), cx, cy, mx, my
                continue
        elif h == _BLIND:
            met[-1] = 1
        if top == _0:
            return
        top -= _1
        w, h = windows[top], np.uint64(crossing[top])
        ax, ay, bx, by, lx, ly, rx, ry = w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7]


@compiled
def _worth(
    ax: float, ay: float, bx: float, by: float, lx: float, ly: float, rx: float, ry: float, sigma: float, limit: float,
    at_a: float, at_b: float,
) -> bool:  # fmt: skip
    """Whether light on edge A B between two rays is near enough, and no path through A or B undercuts it all."""
    ex, ey = bx - ax, by - ay
    length = np.sqrt(ex * ex + ey * ey)
    across = ax * ey - ay * ex
    if abs(across) > (limit - sigma) * length:
        return False
    if at_a == np.inf and at_b == np.inf:
        return True
    left, right = lx * ey - ly * ex, rx * ey - ry * ex
    s = min(max((ax * ly - ay * lx) / left, 0.0), 1.0) if left != 0.0 else 0.0
    t = min(max((ax * ry - ay * rx) / right, 0.0), 1.0) if right != 0.0 else 1.0
    # away from A, light falls behind a path through A by least at the far ray, and so for B
    from_a = sigma + np.sqrt((ax + t * ex) * (ax + t * ex) + (ay + t * ey) * (ay + t * ey))
    from_b = sigma + np.sqrt((ax + s * ex) * (ax + s * ex) + (ay + s * ey) * (ay + s * ey))
    loss = 10 * GRAZING * length
    return from_a <= at_a + t * length + loss and from_b <= at_b + (1.0 - s) * length + loss
