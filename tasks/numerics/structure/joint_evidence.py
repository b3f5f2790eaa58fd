"""Whether a frame's surface shows a joint, or one rigid piece explains it as well: no motion, no joint (ours, for Sec. 6.3).

An alignment slides, most of all about the axes of thin limbs that are cut differently in every frame, and what slides
together looks like a part that turns. So two parts are laid on the surface as one rigid piece, by nearest points as far as
it will go (Besl, McKay 1992), and the smaller of them once more by itself: only if that helps does the surface show a joint.
Where a part moves much farther than its own triangles are rough, nothing is asked; and where one does, the others have to be
hardly better alone than as one piece to go.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.structure.articulated_fit import turns
from kinetree.tasks.numerics.structure.part_tree import Carried, PartTree, Surfaces

Faces = Callable[[int], tuple[Floats, Ints]]

CLEAR = 5.0
"""A part that moves so many times farther than its surface is rough moves; rough is noise and the height of its edges."""
SHOWS = 1.6
"""How many times farther one piece must be off the surface than two, mean of what both kinds of distance say."""
MOVING = 1.1
"""The same where another joint moves clearly: then it is likely that this one does, and coarse limbs show little."""
FEW = 12
"""Vertices with which a piece, which has six freedoms of its own, shows nothing."""
FRAMES, ASKED, ROUNDS = 6, 250, 8
STIFF = 1e-3
"""How firmly a piece is held where its surface leaves it free, as cylinders do."""
WIDE = 3.0
"""Distances, in medians, at which a point counts a half."""
NEAREST = 1e-6
"""Distance that is none, share of the piece's extent."""


class Seen(NamedTuple):
    """What the frames know of an aligned body.

    trust    : (frame, vertex) 0 to 1
    residual : (frame, vertex) distance to the frame's surface as aligned, mesh unit
    surface  : gives a frame's mesh, V (source, xyz) mesh unit and F (face, corner), by its place among the frames
    """

    trust: Floats
    residual: Floats
    surface: Faces


def least_evident_joint(body: Surfaces, parts: Carried, found: PartTree, seen: Seen) -> int:
    """The part whose joint the surface shows least, the smaller one at it; −1 where all joints are shown."""
    rough = _roughness(body)
    mass = np.bincount(parts.label, body.area, parts.R.shape[1])
    order, parents = found.tree.order, found.tree.parents
    sides = [(int(order[k]), int(order[parents[k]])) for k in range(1, len(mass))]
    pairs = [sorted(both, key=lambda p: (mass[p], p)) for both in sides]
    scores = np.array([_shown(body, parts, seen, rough, small, large) for small, large in pairs])
    bar = MOVING if np.isinf(scores).any() else SHOWS
    return pairs[int(scores.argmin())][0] if (scores < bar).any() else -1


def _shown(body: Surfaces, parts: Carried, seen: Seen, rough: Floats, small: int, large: int) -> float:
    """How many times farther from the surface two parts are as one than as two; infinite where that is out of question."""
    mine = np.flatnonzero(parts.label == small)
    if len(mine) < FEW:
        return 0.0
    w = seen.trust[:, mine] * body.area[mine]
    moved = body.V[mine] @ parts.R[:, large].transpose(0, 2, 1) + parts.t[:, None, large]
    way = np.sqrt((w * ((moved - body.x[:, mine]) ** 2).sum(axis=2)).sum(axis=1) / np.maximum(w.sum(axis=1), 1e-300))
    way *= seen.trust[:, mine].mean(axis=1) > 0.5
    if way.max() > CLEAR * np.sqrt(body.area[mine] @ rough[mine] ** 2 / body.area[mine].sum()):
        return np.inf
    mine, others = _some(mine), _some(np.flatnonzero(parts.label == large))
    off = np.array([_off(body, parts, seen, int(f), small, large, mine, others)
                    for f in np.argsort(-way, kind="stable")[:FRAMES]])  # fmt: skip
    one, alone, middle, aligned = np.maximum(np.sqrt((off**2).mean(axis=0)), np.finfo(float).tiny)
    return float(np.sqrt(one / alone * middle / aligned))


def _off(
    body: Surfaces, parts: Carried, seen: Seen, f: int, small: int, large: int, mine: Ints, others: Ints
) -> tuple[float, float, float, float]:
    """How far the smaller part is from frame f: root mean squares as one piece and alone, medians as one and as aligned."""
    V, F = seen.surface(f)
    n = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), np.finfo(float).tiny)
    both = np.concatenate([mine, others])
    count = np.bincount(parts.label, minlength=parts.R.shape[1])[[small, large]] / (len(mine), len(others))
    weight = body.area[both] * seen.trust[f, both] * np.repeat(count, (len(mine), len(others)))
    R, t, distance = _laid(body.V[both], weight, parts.R[f, large], parts.t[f, large], V, F, n)
    w = np.maximum(weight[: len(mine)], 1e-300)
    starts = ((R, t), (parts.R[f, small], parts.t[f, small]))
    alone = min(float(w @ _laid(body.V[mine], w, R, t, V, F, n)[2] ** 2) for R, t in starts)
    one = distance[: len(mine)]
    return (
        float(np.sqrt(w @ one**2 / w.sum())),
        float(np.sqrt(alone / w.sum())),
        float(np.median(one)),
        float(np.median(seen.residual[f, mine])),
    )


def _laid(P: Floats, weight: Floats, R: Floats, t: Floats, V: Floats, F: Ints, n: Floats) -> tuple[Floats, Floats, Floats]:
    """P as one rigid piece on the surface V, F with face normals n, from R, t: R · t · (point,) distances."""
    weight = weight / weight.sum()
    for _ in range(ROUNDS):
        y = P @ R.T + t
        there = projected(y, V, F)
        near = WIDE * float(np.median(there.distance)) + NEAREST * float(np.ptp(y, axis=0).max())
        w = weight / (1.0 + (there.distance / near) ** 2)
        N, goal = n[there.face], np.einsum("pk,pkx->px", there.share, V[F[there.face]])
        c = w @ y / w.sum()
        A = np.concatenate([np.cross(y - c, N), N], axis=1)
        H = A.T @ (w[:, None] * A)
        hold = np.repeat([w @ ((y - c) ** 2).sum(axis=1), w.sum()], 3)
        H[np.diag_indices(6)] += STIFF * np.maximum(hold, np.finfo(float).tiny)
        s = np.linalg.solve(H, A.T @ (w * ((goal - y) * N).sum(axis=1)))
        turn = turns(s[:3])
        R, t = turn @ R, turn @ (t - c) + c + s[3:]
    return R, t, projected(P @ R.T + t, V, F).distance


def _roughness(body: Surfaces) -> Floats:
    """(vertex,) height of each vertex over the mean of its neighbours, mesh unit: noise, and what triangles cut off."""
    start, ring = rings(body.F, len(body.V))
    count = np.diff(start)
    row = np.repeat(np.arange(len(body.V)), count)
    mean = np.stack([np.bincount(row, body.V[ring, k], len(body.V)) for k in range(3)], axis=1)
    height: Floats = np.abs(((body.V - mean / np.maximum(count, 1)[:, None]) * smoothed_normals(body.V, body.F)).sum(axis=1))
    return np.where(count > 0, height, 0.0)


def _some(vertices: Ints) -> Ints:
    """About so many of them as are asked, evenly."""
    return vertices[:: max(len(vertices) // ASKED, 1)]
