"""Whether the frames show a joint, or one rigid piece explains them as well: no motion, no joint (ours, for Sec. 6.3).

An alignment slides, most of all about the axes of thin limbs that are cut differently in every frame, and what slides
together looks like a part that turns. So two parts are laid on the surface as one rigid piece, by iterated closest points
(Besl, McKay 1992), and the smaller of them once more by itself: only if that is nearer does the surface show a joint. A part
that moves much farther than its own triangles are rough has a joint without a test. Where the body has such a joint, the
other joints need less evidence. A joint whose mirror image in the other limb of a pair is shown needs none: a wrist that hardly
turns has the place that the other one has.
"""

from collections.abc import Callable
from functools import lru_cache
from hashlib import blake2b
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.closest_point import SurfaceTree
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import area_vectors, smoothed_normals
from kinetree.tasks.numerics.structure.articulated_fit import rotations
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree

TARGETS = 8
"""Most surfaces that are kept ready at a time; all joints are looked for in few frames, and memory has an end."""
NEAREST = 1e-6
"""Least scale of the weights of closest points, share of the piece's extent; keeps them finite."""


class JointEvidenceSettings(NamedTuple):
    """What makes a joint evident."""

    clear_motion: float
    """Displacement, in roughnesses of its surface, from which on a part moves without a test. Roughness is noise and the
    height of edges. Chosen on still bodies and bodies with one joint of 20°; a twist that slides farther than that would
    stay. Half of it keeps one joint more on a small human, twice as much raises the error of a random tree by half."""
    misfit_ratio: float
    """How many times farther one piece is off the surface than two, at least. Chosen on such bodies: made-up joints had 0.9
    to 1.5 (one 2.2), elbows that turn by 20° 1.5 to 3.8. Halved or doubled it moves no joint of two generated bodies: on
    both some joint moves clearly."""
    misfit_ratio_if_moving: float
    """The same where another joint moves clearly. Chosen on a walking body of 1,000 vertices, whose elbows, wrists and
    ankles have 1.1 to 1.6. The most sensitive of all: twice as much leaves 5 of 12 joints of a small human, half of it
    finds one more."""
    least_vertices: int = 12
    """Vertices below which a part has no evidence, since a rigid piece has six freedoms. Not recorded. Halved or doubled it
    moves no joint of two generated bodies; it guards the fit of tiny parts, which has no answer."""
    frames: int = 6
    """Frames in which parts are laid on the surface: those in which the smaller moves farthest. Not recorded; for time.
    Halved or doubled it moves no joint of two generated bodies."""
    sample: int = 250
    """Vertices of each part, about. Not recorded; for time. Halved or doubled it moves no joint of two generated bodies."""
    rounds: int = 8
    """Rounds of closest points. Not recorded. Halved or doubled it moves no joint of two generated bodies; it ends fits
    that go on in small steps."""
    stiffness: float = 1e-3
    """How firmly a piece is held where its surface leaves it free, as cylinders do; share of its inertia. Not recorded.
    Halved or doubled it moves no joint of two generated bodies; without it round pieces leave the equations singular."""
    outlier: float = 3.0
    """Distance, in medians, at which a closest point counts a half. Not recorded. Halved or doubled it moves no joint of
    two generated bodies; it guards against holes of a frame."""


class _Target(NamedTuple):
    """A frame's surface, on which pieces are laid.

    V, F : (vertex, xyz) mesh unit · (face, corner)
    n    : (face, xyz) unit normals; 0 where a face has no area
    tree : to ask for nearest points
    """

    V: Floats
    F: Ints
    n: Floats
    tree: SurfaceTree

    @staticmethod
    def of(V: Floats, F: Ints) -> "_Target":
        """The surface made ready."""
        n = area_vectors(V, F)
        n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), np.finfo(float).tiny)
        return _Target(V, F, n, SurfaceTree.of(V, F))


class _Fit(NamedTuple):
    """A piece laid on a frame's surface: x = R v + t, and the distance of each of its points."""

    R: Floats
    t: Floats
    distance: Floats


class FrameEvidence(NamedTuple):
    """The frames' surfaces, and how well an aligned body lies on them; remembers what was laid on them.

    confidence : (frame, vertex) 0 to 1
    residual   : (frame, vertex) distance to the frame's surface as aligned, mesh unit
    target     : gives a frame's surface, ready, by its place among the frames
    settings   : what makes a joint evident in them
    known      : the fits so far: where one part is dropped, most of the others are laid on the same frames again
    """

    confidence: Floats
    residual: Floats
    target: Callable[[int], _Target]
    settings: JointEvidenceSettings
    known: dict[tuple[int, JointEvidenceSettings, bytes], _Fit]

    @staticmethod
    def of(
        confidence: Floats,
        residual: Floats,
        surface: Callable[[int], tuple[Floats, Ints]],
        settings: JointEvidenceSettings,
    ) -> "FrameEvidence":
        """Nothing is laid on the frames yet; `surface` gives a frame's mesh, V (source, xyz) mesh unit and F (face, corner)."""
        ready = lru_cache(maxsize=TARGETS)(lambda f: _Target.of(*surface(f)))
        return FrameEvidence(confidence, residual, ready, settings, {})

    def laid(self, f: int, P: Floats, weight: Floats, R: Floats, t: Floats) -> _Fit:
        """P (point, xyz) as one rigid piece on the surface of frame f, from R, t."""
        told = blake2b(digest_size=16)
        for given in (P, weight, R, t):
            told.update(given.tobytes())
        key = f, self.settings, told.digest()
        if key not in self.known:
            self.known[key] = _registered(P, weight, R, t, self.target(f), self.settings)
        return self.known[key]


def least_evident_joint(
    body: MovingSurface, parts: MovingParts, tree: PartTree, evidence: FrameEvidence, partner: Ints | None = None
) -> int:
    """The smaller part at the joint that the frames show least, of those whose mirror image they do not show either; −1 where
    there is none.

    body, parts, tree : the reference and its vertices in all frames · its rigid parts · their tree
    partner           : (part,) see `joint_partners`; None where no joint has one
    """
    chosen = evidence.settings
    roughness = _roughness(body)
    mass = np.bincount(parts.label, body.area, parts.R.shape[1])
    order, parents = tree.tree.order, tree.tree.parents
    sides = [(int(order[k]), int(order[parents[k]])) for k in range(1, len(mass))]
    pairs = [sorted(both, key=lambda p: (mass[p], p)) for both in sides]
    scores = np.array([_score(body, parts, evidence, roughness, small, large) for small, large in pairs])
    needed = chosen.misfit_ratio_if_moving if np.isinf(scores).any() else chosen.misfit_ratio
    is_shown = ~(scores < needed)  # parts that no frame sees have no score and stay
    if partner is not None:
        is_shown |= (partner[1:] > 0) & is_shown[np.maximum(partner[1:], 1) - 1]
    unseen = np.where(is_shown, np.inf, scores)
    return pairs[int(unseen.argmin())][0] if not is_shown.all() else -1


def _score(
    body: MovingSurface,
    parts: MovingParts,
    evidence: FrameEvidence,
    roughness: Floats,
    small: int,
    large: int,
) -> float:
    """How many times farther from the surface two parts are as one than as two; infinite where the smaller moves clearly."""
    chosen = evidence.settings
    own = np.flatnonzero(parts.label == small)
    if len(own) < chosen.least_vertices:
        return 0.0
    w = evidence.confidence[:, own] * body.area[own]
    carried = body.V[own] @ parts.R[:, large].transpose(0, 2, 1) + parts.t[:, None, large]
    moved = np.sqrt((w * ((carried - body.x[:, own]) ** 2).sum(axis=2)).sum(axis=1) / np.maximum(w.sum(axis=1), 1e-300))
    moved *= evidence.confidence[:, own].mean(axis=1) > 0.5
    if moved.max() > chosen.clear_motion * np.sqrt(body.area[own] @ roughness[own] ** 2 / body.area[own].sum()):
        return np.inf
    own, others = _evenly(own, chosen.sample), _evenly(np.flatnonzero(parts.label == large), chosen.sample)
    frames = np.argsort(-moved, kind="stable")[: chosen.frames]
    distances = np.array([_distances(body, parts, evidence, int(f), small, large, own, others) for f in frames])
    one, alone, median, aligned = np.maximum(np.sqrt((distances**2).mean(axis=0)), np.finfo(float).tiny)
    return float(np.sqrt(one / alone * median / aligned))


def _distances(
    body: MovingSurface,
    parts: MovingParts,
    evidence: FrameEvidence,
    f: int,
    small: int,
    large: int,
    own: Ints,
    others: Ints,
) -> tuple[float, float, float, float]:
    """The smaller part's distances to frame f: root mean squares as one piece and alone, medians as one and as aligned."""
    both = np.concatenate([own, others])
    count = np.bincount(parts.label, minlength=parts.R.shape[1])[[small, large]] / (len(own), len(others))
    weight = body.area[both] * evidence.confidence[f, both] * np.repeat(count, (len(own), len(others)))
    R, t, distance = evidence.laid(f, body.V[both], weight, parts.R[f, large], parts.t[f, large])
    w = np.maximum(weight[: len(own)], 1e-300)
    starts = ((R, t), (parts.R[f, small], parts.t[f, small]))
    alone = min(float(w @ evidence.laid(f, body.V[own], w, Q, u).distance ** 2) for Q, u in starts)
    one = distance[: len(own)]
    return (
        float(np.sqrt(w @ one**2 / w.sum())),
        float(np.sqrt(alone / w.sum())),
        float(np.median(one)),
        float(np.median(evidence.residual[f, own])),
    )


def _registered(P: Floats, weight: Floats, R: Floats, t: Floats, target: _Target, chosen: JointEvidenceSettings) -> _Fit:
    """P as one rigid piece on a surface, from R, t."""
    weight = weight / weight.sum()
    for _ in range(chosen.rounds):
        y = P @ R.T + t
        closest = target.tree.nearest(y)
        near = chosen.outlier * float(np.median(closest.distance)) + NEAREST * float(np.ptp(y, axis=0).max())
        w = weight / (1.0 + (closest.distance / near) ** 2)
        N, goal = target.n[closest.face], np.einsum("pk,pkx->px", closest.share, target.V[target.F[closest.face]])
        c = w @ y / w.sum()
        A = _lines(y - c, N)
        H = A.T @ (w[:, None] * A)
        hold = np.repeat([w @ ((y - c) ** 2).sum(axis=1), w.sum()], 3)
        H[np.diag_indices(6)] += chosen.stiffness * np.maximum(hold, np.finfo(float).tiny)
        s = np.linalg.solve(H, A.T @ (w * ((goal - y) * N).sum(axis=1)))
        turn = rotations(s[:3])
        R, t = turn @ R, turn @ (t - c) + c + s[3:]
    return _Fit(R, t, target.tree.nearest(P @ R.T + t).distance)


def _lines(arm: Floats, N: Floats) -> Floats:
    """(point, 6) arm × N and N: how far along N each point goes with a turn and a shift."""
    A = np.empty((len(N), 6))
    for k, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        A[:, k] = arm[:, i] * N[:, j] - arm[:, j] * N[:, i]
    A[:, 3:] = N
    return A


def _roughness(body: MovingSurface) -> Floats:
    """(vertex,) height of each vertex over the mean of its neighbours, mesh unit: noise, and what triangles cut off."""
    start, ring = rings(body.F, len(body.V))
    count = np.diff(start)
    row = np.repeat(np.arange(len(body.V)), count)
    mean = np.stack([np.bincount(row, body.V[ring, k], len(body.V)) for k in range(3)], axis=1)
    height: Floats = np.abs(((body.V - mean / np.maximum(count, 1)[:, None]) * smoothed_normals(body.V, body.F)).sum(axis=1))
    return np.where(count > 0, height, 0.0)


def _evenly(vertices: Ints, count: int) -> Ints:
    """About so many of them, evenly."""
    return vertices[:: max(len(vertices) // count, 1)]
