"""One piece of a body, or two that are joined by a hinge, laid on the surface of a frame (Besl, McKay 1992; the hinge ours).

By Gauss–Newton over the motion of the piece and, if it is two, the rotation of the far one against the other about the hinge:
E = Σ w [(n · d)² + along |d|²] + anchor M |joint − goal|² + hold |Q − I|² / 2, from wide to narrow; d leads to the matched
vertex of the frame, n is its normal, and M the whole weight. All steps of a fit run in one compiled function: a piece has a few
hundred points, and calls of array functions took most of the time.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.small_matrices import product, rotation, solved
from kinetree.tasks.numerics.registration.correspondence import Target, local_matches


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


class _Surface(NamedTuple):
    """What matches are sought on, see `Target`."""

    V: Floats
    N: Floats
    start: Ints
    ring: Ints
    beta: float
    size: float


def piece_fit(
    piece: Piece, start: PiecePose, goal: Floats, target: Target, match: Ints, *, hinged: bool,
    settings: PieceFitSettings | None = None,
) -> PieceFit:  # fmt: skip
    """The piece on the surface of a frame, from a pose and matches that are not too far.

    goal   : (xyz,) where the rest of the body has the piece's joint, mesh unit
    match  : (point,) vertices of the frame near the points
    hinged : whether the far piece turns by itself; if not it keeps the turn that it has
    """
    surface = _Surface(target.V, target.N, target.start, target.ring, float(target.beta), float(target.size))
    R, t, Q, square, match = _fitted(piece, start, goal, surface, match, hinged, settings or PieceFitSettings())
    return PieceFit(PiecePose(R, t, Q), square, match)


def shift_stiffness(piece: Piece, fit: PieceFit, target: Target, settings: PieceFitSettings | None = None) -> Floats:
    """(6, 6) how firmly the matches hold the piece where it lies: of a turn about its joint, radian, then a shift, mesh unit.

    The mean over the piece of w [n nᵀ + along I] as it acts on the points' displacements, w as in the last step of a fit.
    """
    chosen = settings or PieceFitSettings()
    y, n, _ = placed_piece(piece, fit.pose)
    normal, d = target.N[fit.match], target.V[fit.match] - y
    across, cosine = (d * normal).sum(axis=1), (n * normal).sum(axis=1)
    near = (across**2 + chosen.weighed_along * (d**2).sum(axis=1)) / (chosen.scales[-1] * target.size) ** 2
    w = np.where(cosine > chosen.least_cosine, piece.mass * cosine / (1.0 + near) ** 2, 0.0) / piece.mass.sum()
    J, lever = np.empty((len(y), 6, 4)), y - (fit.pose.R @ piece.joint + fit.pose.t)
    J[:, :3, 0], J[:, 3:, 0] = np.cross(lever, normal), normal
    J[:, :3, 1:] = np.sqrt(chosen.along) * np.cross(lever[:, None], np.eye(3)).transpose(0, 2, 1)
    J[:, 3:, 1:] = np.sqrt(chosen.along) * np.eye(3)
    return np.asarray(np.einsum("p,pik,pjk->ij", w, J, J))


@compiled
def placed_piece(piece: Piece, pose: PiecePose) -> tuple[Floats, Floats, Floats]:
    """(point, xyz) the points, mesh unit · (point, xyz) their unit normals · (xyz,) the hinge."""
    y, n, C, near, hinge = np.empty(piece.V.shape), np.empty(piece.V.shape), np.empty(3), pose.R, piece.hinge
    beyond = product(near, pose.Q)
    for x in range(3):
        C[x] = near[x, 0] * hinge[0] + near[x, 1] * hinge[1] + near[x, 2] * hinge[2] + pose.t[x]
    for i in range(len(y)):
        R = beyond if piece.far[i] else near
        a, b, c = piece.V[i, 0] - hinge[0], piece.V[i, 1] - hinge[1], piece.V[i, 2] - hinge[2]
        for x in range(3):
            y[i, x] = R[x, 0] * a + R[x, 1] * b + R[x, 2] * c + C[x]
            n[i, x] = R[x, 0] * piece.N[i, 0] + R[x, 1] * piece.N[i, 1] + R[x, 2] * piece.N[i, 2]
    return y, n, C


@compiled
def _fitted(
    piece: Piece, start: PiecePose, goal: Floats, on: _Surface, match: Ints, hinged: bool, chosen: PieceFitSettings
) -> tuple[Floats, Floats, Floats, Floats, Ints]:
    """Rotation, shift and turn of the far piece after all steps, and squares and matches of `PieceFit`."""
    R, t, Q, turning = start.R.copy(), start.t.copy(), start.Q.copy(), 9 if hinged else 6
    inertia = _inertia(piece)
    for scale in chosen.scales:
        y, n, C = placed_piece(piece, PiecePose(R, t, Q))
        match = local_matches(y, n, match, on.V, on.N, on.start, on.ring, on.beta)
        H, g = np.zeros((9, 9)), np.zeros(9)
        _add_matches(H, g, y, n, match, piece, on, C, (scale * on.size) ** 2, chosen)
        _add_holds(H, g, piece, R, Q, C, goal, inertia, chosen)
        step = solved(H, g, turning)
        before, R = R, product(rotation(step[:3], chosen.longest_step), R)
        for x in range(3):
            t[x] = C[x] + step[3 + x] - (R[x, 0] * piece.hinge[0] + R[x, 1] * piece.hinge[1] + R[x, 2] * piece.hinge[2])
        if hinged:
            own = product(rotation(step[6:], chosen.longest_step), before)
            Q = product(product(before.T, own), Q)
    y, n, C = placed_piece(piece, PiecePose(R, t, Q))
    match = local_matches(y, n, match, on.V, on.N, on.start, on.ring, on.beta)
    return R, t, Q, _squares(y, n, match, on, chosen), match


@compiled
def _squares(y: Floats, n: Floats, match: Ints, on: _Surface, chosen: PieceFitSettings) -> Floats:
    """(point,) squared distance to the surface, mesh unit²; see `left_along` and `most_left`."""
    out, off = np.empty(len(y)), (chosen.most_left * on.size) ** 2
    for i in range(len(y)):
        cosine, across, square = _met(y, n, i, on, match[i])
        out[i] = min(across * across + chosen.left_along * square, off) if cosine > chosen.least_cosine else off
    return out


@compiled
def _met(y: Floats, n: Floats, i: int, on: _Surface, u: int) -> tuple[float, float, float]:
    """Cosine of the normals of point i and vertex u, distance along the latter's, squared distance."""
    cosine, across, square = 0.0, 0.0, 0.0
    for x in range(3):
        d = on.V[u, x] - y[i, x]
        cosine += n[i, x] * on.N[u, x]
        across += d * on.N[u, x]
        square += d * d
    return cosine, across, square


@compiled
def _add_matches(
    H: Floats, g: Floats, y: Floats, n: Floats, match: Ints, piece: Piece, on: _Surface, C: Floats, scale2: float,
    chosen: PieceFitSettings,
) -> None:  # fmt: skip
    """Adds the equations of all matches: turn about the hinge and shift of all points, turn of the far ones.

    y, n : (point, xyz) mesh unit · unit normals, C : (xyz,) the hinge
    """
    G, h, J, r, f = np.zeros((2, 6, 6)), np.zeros((2, 6)), np.empty(6), np.empty(3), np.empty(3)
    for i in range(len(y)):
        u = match[i]
        cosine, across, square = _met(y, n, i, on, u)
        if cosine <= chosen.least_cosine:
            continue
        w = piece.mass[i] * cosine / (1.0 + (across * across + chosen.weighed_along * square) / scale2) ** 2
        side = 1 if piece.far[i] else 0
        for x in range(3):
            r[x] = y[i, x] - C[x]
            f[x] = w * (across * on.N[u, x] + chosen.along * (on.V[u, x] - y[i, x]))
        for x in range(3):
            a, b = (x + 1) % 3, (x + 2) % 3
            J[x], J[3 + x] = r[a] * on.N[u, b] - r[b] * on.N[u, a], on.N[u, x]
        for p in range(6):
            for q in range(p, 6):
                G[side, p, q] += w * J[p] * J[q]
        _add_pull(G[side], h[side], r, f, w * chosen.along)
    for p in range(6):
        g[p] += h[0, p] + h[1, p]
        for q in range(p, 6):
            H[p, q] += G[0, p, q] + G[1, p, q]
        for q in range(3):
            H[p, 6 + q] += G[1, min(p, q), max(p, q)]
    for p in range(3):
        g[6 + p] += h[1, p]
        for q in range(p, 3):
            H[6 + p, 6 + q] += G[1, p, q]


@compiled
def _add_pull(G: Floats, h: Floats, r: Floats, f: Floats, w: float) -> None:
    """Adds w |ω × r + s|² / 2 − f · (ω × r + s) to the equations of a turn ω and a shift s, above the diagonal alone."""
    for x in range(3):
        a, b = (x + 1) % 3, (x + 2) % 3
        h[x] += r[a] * f[b] - r[b] * f[a]
        h[3 + x] += f[x]
        G[x, x] += w * (r[a] * r[a] + r[b] * r[b])
        G[min(x, a), max(x, a)] -= w * r[x] * r[a]
        G[x, 3 + a] -= w * r[b]
        G[x, 3 + b] += w * r[a]
        G[3 + x, 3 + x] += w


@compiled
def _add_holds(
    H: Floats, g: Floats, piece: Piece, R: Floats, Q: Floats, C: Floats, goal: Floats, inertia: Floats, chosen: PieceFitSettings
) -> None:
    """Adds the joint's anchor, and what keeps free turns from running away; inertia (2,) of the near and the far piece."""
    lever, pull, axis, mass = np.zeros(3), np.empty(3), np.empty(3), 0.0
    for i in range(len(piece.mass)):
        mass += piece.mass[i]
    firm, hold, damping = chosen.anchor * mass, chosen.hold * inertia[1], inertia[0] + inertia[1]
    for x in range(3):
        a, b = (x + 1) % 3, (x + 2) % 3
        for k in range(3):
            lever[x] += R[x, k] * (piece.joint[k] - piece.hinge[k])
        pull[x] = firm * (goal[x] - C[x] - lever[x])
        axis[x] = Q[b, a] - Q[a, b]
    _add_pull(H, g, lever, pull, firm)
    for x in range(3):
        g[6 + x] -= hold / 2.0 * (R[x, 0] * axis[0] + R[x, 1] * axis[1] + R[x, 2] * axis[2])
        H[x, x] += 1e-6 * damping
        H[3 + x, 3 + x] += 1e-9 * mass
        H[6 + x, 6 + x] += hold + 1e-12 * damping


@compiled
def _inertia(piece: Piece) -> Floats:
    """(2,) of the near and the far piece about the hinge, mesh unit² times mass."""
    out = np.zeros(2)
    for i in range(len(piece.V)):
        for x in range(3):
            out[1 if piece.far[i] else 0] += piece.mass[i] * (piece.V[i, x] - piece.hinge[x]) ** 2
    return out
