"""One piece of a body, or two that are joined by a hinge, laid on the surface of a frame (Besl, McKay 1992; the hinge ours).

By Gauss–Newton over the motion of the piece and, if it is two, the rotation of the far one against the other about the hinge:
E = Σ w [(n · d)² + along |d|²] + anchor M |joint − goal|² + hold |Q − I|² / 2, from wide to narrow; d leads to the matched
vertex of the frame, n is its normal, and M the whole weight.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.registration.correspondence import Target, local_matches
from kinetree.tasks.numerics.structure.articulated_fit import rotations


class PieceFitSettings(NamedTuple):
    """How pieces are laid on a surface; lengths are shares of the root of the body's area.

    Written down once and not varied, but for `anchor`.
    """

    scales: tuple[float, ...] = (0.03, 0.02, 0.012, 0.008, 0.006, 0.006)
    """Distance at which a match counts a quarter, step by step."""
    along: float = 0.03
    """Weight of a match's distance along the surface against that across it."""
    anchor: float = 0.03
    """Weight of the joint against all matches. With ten times as much, pieces whose joint is badly placed are not free to lie
    on the surface as one, and a tail, a paw and a limb of a random tree get hinges that they do not have."""
    hold: float = 1e-3
    """How firmly the far piece is held where its surface leaves it free, as a round one does; share of its inertia."""
    least_cosine: float = 0.3
    """Cosine of two normals below which two points do not match."""
    weighed_along: float = 0.1
    """Weight of a distance along the surface against one across it when matches are weighed."""
    left_along: float = 0.02
    """The same in what is left in the end: vertices never lie on vertices."""
    most_left: float = 0.02
    """Distance from the surface from which on a point is off, no matter how far."""
    longest_step: float = 0.4
    """Radians by which a piece turns in one step, at most."""


class Piece(NamedTuple):
    """Points of a body's surface in the reference.

    V, N  : (point, xyz) mesh unit · (point, xyz) unit normals
    mass  : (point,) weight of each
    far   : (point,) whether each lies beyond the hinge
    hinge : (xyz,) mesh unit
    joint : (xyz,) where the piece hangs on the rest of the body, mesh unit
    """

    V: Floats
    N: Floats
    mass: Floats
    far: Flags
    hinge: Floats
    joint: Floats


class PiecePose(NamedTuple):
    """A piece in a frame.

    R, t : (3, 3) · (xyz,) from the reference, mesh unit
    Q    : (3, 3) turn of the far piece before the piece is moved
    """

    R: Floats
    t: Floats
    Q: Floats


class PieceFit(NamedTuple):
    """A piece on the surface.

    pose   : where it lies
    square : (point,) squared distance to the surface, mesh unit²
    match  : (point,) vertex of the frame
    """

    pose: PiecePose
    square: Floats
    match: Ints

    def cost(self, mass: Floats) -> float:
        """Mean squared distance by mass, mesh unit²."""
        return float(mass @ self.square / mass.sum())


def piece_fit(
    piece: Piece, start: PiecePose, goal: Floats, target: Target, match: Ints, *, hinged: bool,
    settings: PieceFitSettings | None = None,
) -> PieceFit:  # fmt: skip
    """The piece on the surface of a frame, from a pose and matches that are not too far.

    goal   : (xyz,) where the rest of the body has the piece's joint, mesh unit
    match  : (point,) vertices of the frame near the points
    hinged : whether the far piece turns by itself; if not it keeps the turn that it has
    """
    chosen, pose = settings or PieceFitSettings(), start
    free = 9 if hinged else 6
    for scale in chosen.scales:
        y, n, C = placed_piece(piece, pose)
        match = local_matches(y, n, match, target.V, target.N, target.start, target.ring, target.beta)
        H, g = np.zeros((9, 9)), np.zeros(9)
        limits = ((scale * target.size) ** 2, chosen.least_cosine, chosen.weighed_along, chosen.along)
        _add_matches(H, g, y, n, target.V[match], target.N[match], piece.mass, piece.far, C, *limits)
        _add_holds(H, g, piece, pose, y - C, C, goal, chosen)
        step = np.zeros(9)
        step[:free] = np.linalg.solve(H[:free, :free], g[:free])
        pose = _moved(pose, step, C, piece.hinge, chosen.longest_step)
    y, n, _ = placed_piece(piece, pose)
    match = local_matches(y, n, match, target.V, target.N, target.start, target.ring, target.beta)
    d, m = target.V[match] - y, target.N[match]
    square = np.einsum("px,px->p", d, m) ** 2 + chosen.left_along * (d**2).sum(axis=1)
    off = (chosen.most_left * target.size) ** 2
    alike = np.einsum("px,px->p", n, m) > chosen.least_cosine
    return PieceFit(pose, np.where(alike, np.minimum(square, off), off), match)


def placed_piece(piece: Piece, pose: PiecePose) -> tuple[Floats, Floats, Floats]:
    """(point, xyz) the points, mesh unit · (point, xyz) their unit normals · (xyz,) the hinge."""
    C = pose.R @ piece.hinge + pose.t
    y, n, turn = piece.V @ pose.R.T + pose.t, piece.N @ pose.R.T, (pose.R @ pose.Q).T
    y[piece.far], n[piece.far] = (piece.V[piece.far] - piece.hinge) @ turn + C, piece.N[piece.far] @ turn
    return y, n, C


def _moved(pose: PiecePose, step: Floats, C: Floats, hinge: Floats, longest: float) -> PiecePose:
    """The pose after a step: turn of the piece, shift of its hinge at C, turn of the far piece in space."""
    turn, own = (rotations(_limited(w, longest)[None])[0] for w in (step[:3], step[6:]))
    R = turn @ pose.R
    return PiecePose(R, C + step[3:6] - R @ hinge, pose.R.T @ own @ pose.R @ pose.Q)


def _limited(w: Floats, longest: float) -> Floats:
    return w * min(1.0, longest / max(float(np.linalg.norm(w)), 1e-12))


def _add_holds(
    H: Floats, g: Floats, piece: Piece, pose: PiecePose, r: Floats, C: Floats, goal: Floats, chosen: PieceFitSettings
) -> None:
    """Adds the joint's anchor, and what keeps free turns from running away; r (point, xyz) from the hinge."""
    q = pose.R @ (piece.joint - piece.hinge)
    K = np.array([[0, q[2], -q[1], 1, 0, 0], [-q[2], 0, q[0], 0, 1, 0], [q[1], -q[0], 0, 0, 0, 1]])
    firm = chosen.anchor * piece.mass.sum()
    H[:6, :6] += firm * K.T @ K
    g[:6] += firm * K.T @ (goal - C - q)
    inertia = piece.mass * np.einsum("px,px->p", r, r)
    hold = chosen.hold * inertia[piece.far].sum()
    Q = pose.Q
    g[6:] -= hold / 2 * (pose.R @ np.array([Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1]]))
    H[np.arange(9), np.arange(9)] += np.repeat([1e-6 * inertia.sum(), 1e-9 * piece.mass.sum(), hold + 1e-12 * inertia.sum()], 3)


@compiled
def _add_matches(
    H: Floats, g: Floats, y: Floats, n: Floats, V: Floats, N: Floats, mass: Floats, far: Flags, C: Floats, scale2: float,
    least_cosine: float, weighed_along: float, along: float,
) -> None:  # fmt: skip
    """Adds the equations of all matches: turn about the hinge and shift of all points, turn of the far ones.

    y, n : (point, xyz) mesh unit · unit normals, V, N : (point, xyz) their matches
    """
    J, K = np.zeros(9), np.zeros((3, 9))
    for i in range(len(y)):
        cosine, off, square = 0.0, 0.0, 0.0
        for x in range(3):
            d = V[i, x] - y[i, x]
            cosine += n[i, x] * N[i, x]
            off += d * N[i, x]
            square += d * d
        if cosine <= least_cosine:
            continue
        w = mass[i] * cosine / (1.0 + (off * off + weighed_along * square) / scale2) ** 2
        for x in range(3):
            a, b = (x + 1) % 3, (x + 2) % 3
            J[x] = (y[i, a] - C[a]) * N[i, b] - (y[i, b] - C[b]) * N[i, a]
            J[3 + x] = N[i, x]
            J[6 + x] = J[x] if far[i] else 0.0
            K[x, 3 + x] = 1.0
            K[x, a], K[x, b] = y[i, b] - C[b], C[a] - y[i, a]
            K[x, 6 + a], K[x, 6 + b] = (K[x, a], K[x, b]) if far[i] else (0.0, 0.0)
        for p in range(9):
            g[p] += w * off * J[p]
            for x in range(3):
                g[p] += w * along * (V[i, x] - y[i, x]) * K[x, p]
            for q in range(9):
                H[p, q] += w * (J[p] * J[q] + along * (K[0, p] * K[0, q] + K[1, p] * K[1, q] + K[2, p] * K[2, q]))
