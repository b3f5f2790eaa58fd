"""The last part of a limb as one piece and with a hinge on the surface of a frame, and the skin that goes with it (ours)."""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFit, PieceFitSettings, PiecePose, piece_fit, placed_piece

BETTER = 0.98
"""What is left with another turn to start from, share of what is left without, at most. Not recorded."""
BEND = 0.6
"""Radians by which the hinge at the end of a limb with a mirror image is bent to begin with. On sixteen clips of a rigged body
0.35 finds one joint of 244 less."""
POINTS = 250
"""Points of a part, about; for time."""
SAMPLE = 6000
"""Vertices that stand for a frame's surface; for time."""


class HingedFit(NamedTuple):
    """A part in one frame.

    one, two : mean squared distance from the surface as one piece, and with the hinge, mesh unit²
    pose     : with the hinge
    """

    one: float
    two: float
    pose: PiecePose


def sampled_piece(V: Floats, N: Floats, weight: Floats, far: Flags, hinge: Floats, joint: Floats) -> Piece:
    """Points of a part, those that follow it most with most mass.

    V, N   : (vertex, xyz) of the part in the reference, mesh unit · (vertex, xyz) unit normals
    weight : (vertex,) how much each follows the part, 0 to 1
    far    : (vertex,) whether each lies beyond the hinge
    hinge, joint : see `Piece`
    """
    at = slice(None, None, max(len(V) // POINTS, 1))
    points, normals, beyond = np.ascontiguousarray(V[at]), np.ascontiguousarray(N[at]), np.ascontiguousarray(far[at])
    return Piece(points, normals, np.maximum(weight[at], 1e-3) ** 2, beyond, hinge, joint)


def halves(piece: Piece) -> tuple[Piece, Piece]:
    """The piece twice: all points before the hinge, and of those beyond it the odd ones or the even ones, twice as heavy."""
    nth = np.cumsum(piece.far) % 2
    first, second = (_with(piece, ~piece.far | (nth == side)) for side in (1, 0))
    return first, second


def _with(piece: Piece, kept: Flags) -> Piece:
    """The piece with these of its points, those beyond the hinge twice as heavy."""
    mass = np.where(piece.far, 2.0, 1.0) * piece.mass
    return piece._replace(V=piece.V[kept], N=piece.N[kept], mass=mass[kept], far=piece.far[kept])


def laid_as_one(
    piece: Piece, start: PiecePose, goal: Floats, target: Target, settings: PieceFitSettings | None = None
) -> PieceFit:
    """The part as one piece from where it is; goal (xyz,) is where the rest of the body has its joint, mesh unit."""
    return piece_fit(piece, start, goal, target, _first_matches(piece, start, target), hinged=False, settings=settings)


def laid_hinged(
    piece: Piece, one: PieceFit, goal: Floats, target: Target, turn: Floats | None, *, is_bent: bool = False
) -> HingedFit:
    """The part with the hinge, from where it lies as one piece, and from other turns of the hinge where that is better.

    turn    : (3, 3) that of another frame
    is_bent : whether the hinge, as first fitted, is also bent to either side (`BEND`): small steps do not reach what turns far
    """
    best = piece_fit(piece, one.pose, goal, target, one.match, hinged=True)
    for Q in (*(() if turn is None else (turn,)), *(_bent(piece, best.pose.Q) if is_bent else ())):
        start = one.pose._replace(Q=Q)
        other = piece_fit(piece, start, goal, target, _first_matches(piece, start, target), hinged=True)
        if other.cost(piece.mass) < BETTER * best.cost(piece.mass):
            best = other
    return HingedFit(one.cost(piece.mass), best.cost(piece.mass), best.pose)


def _first_matches(piece: Piece, pose: PiecePose, target: Target) -> Ints:
    """(point,) vertices of the frame that are nearest to the points."""
    y, n, _ = placed_piece(piece, pose)
    return target.nearest(y, n)


def _bent(piece: Piece, Q: Floats) -> tuple[Floats, ...]:
    """Turns (3, 3) of the hinge, Q bent to either side about the axis along which the far piece is widest across its length.

    Of a round piece any axis across it is one. None where no point lies beyond the hinge.
    """
    beyond = piece.V[piece.far] - piece.hinge
    if not len(beyond):
        return ()
    along = beyond.mean(axis=0)
    along = along / max(float(np.linalg.norm(along)), np.finfo(float).tiny)
    across = beyond - (beyond @ along)[:, None] * along
    axis = np.linalg.eigh(across.T @ across)[1][:, 2]
    return tuple(Q @ Rotation.from_rotvec(angle * axis).as_matrix() for angle in (-BEND, BEND))


def turns_of_halves(both: tuple[Piece, Piece], start: PiecePose, goal: Floats, target: Target) -> tuple[Floats, Floats]:
    """(3, 3) · (3, 3) the turn of the hinge as each half is fitted from the same pose.

    both : see `halves`
    goal : (xyz,) where the rest of the body has the part's joint, mesh unit
    """
    first, second = (_turn(piece, start, goal, target) for piece in both)
    return first, second


def _turn(piece: Piece, start: PiecePose, goal: Floats, target: Target) -> Floats:
    """(3, 3) the turn of the hinge as the piece is fitted from a pose."""
    return piece_fit(piece, start, goal, target, _first_matches(piece, start, target), hinged=True).pose.Q


def motions(pose: PiecePose, hinge: Floats) -> tuple[Floats, Floats]:
    """(2, 3, 3) · (2, xyz) of the nearer piece and of the farther one, from the reference; hinge (xyz,) mesh unit."""
    R = np.stack([pose.R, pose.R @ pose.Q])
    return R, np.stack([pose.t, pose.R @ hinge + pose.t - R[1] @ hinge])


def on_pieces(V: Floats, x: Floats, weight: Floats, share: Floats, R: Floats, t: Floats) -> Floats:
    """Aligned vertices put where the two pieces carry them, each by how much it follows these.

    V, x    : (vertex, xyz) in the reference, in a frame, mesh unit
    weight  : (vertex,) how much each follows the two pieces, 0 to 1
    share   : (vertex,) of it that the farther one has
    R, t    : see `motions`
    returns : (vertex, xyz) mesh unit
    """
    near, far = (V @ Q.T + u for Q, u in zip(R, t, strict=True))
    carried = near + share[:, None] * (far - near)
    return np.asarray(x + weight[:, None] * (carried - x))
