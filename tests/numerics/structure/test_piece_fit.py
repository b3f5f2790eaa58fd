"""Pieces come to lie on a surface, and a hinge turns as the surface does."""

import numpy as np
import pytest
from articulated import chain
from limbs import rotation

from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.piece_fit import Piece, PieceFit, PiecePose, piece_fit, placed_piece, shift_stiffness

HINGE = np.array([0.0, 0.0, 2.0])
I3 = np.eye(3)


def laid(degrees: float, hinged: bool, moved: np.ndarray = I3, scale: float = 1.0) -> tuple[Piece, PieceFit, float]:
    """A straight tube from 0 to 5 laid on one that is bent at 2 and moved as a whole."""
    body = chain((0.0, 2.0), along=60)
    v = np.flatnonzero(body.V[:, 2] > 0.0)
    turn = np.tile(I3, (1, 3, 1, 1))
    turn[0, 2] = rotation((1.0, 0.0, 0.0), np.deg2rad(degrees))
    true = chain((0.0, 2.0), turn, around=27, along=83)
    size = scale * float(np.sqrt(body.area.sum()))
    target = Target.of(scale * true.x[0] @ moved.T, true.F, size)
    V, N = scale * body.V[v], smoothed_normals(body.V, body.F)[v]
    piece = Piece(V, N, np.ones(len(v)), V[:, 2] > scale * 2.0, scale * HINGE, np.zeros(3))
    start = PiecePose(rotation((0.0, 1.0, 0.0), 0.05) @ moved, np.zeros(3), I3)
    y, n, _ = placed_piece(piece, start)
    return piece, piece_fit(piece, start, np.zeros(3), target, target.nearest(y, n), hinged=hinged), size


def angle(R: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(R) - 1) / 2, -1, 1))))


@pytest.mark.parametrize("degrees", [-20.0, 8.0, 20.0])
@pytest.mark.parametrize("moved", [I3, rotation((1.0, 2.0, 3.0), 0.8)], ids=["in place", "moved as a whole"])
def test_hinge_turns_as_the_surface_does(degrees: float, moved: np.ndarray) -> None:
    _, fit, _ = laid(degrees, True, moved)
    assert angle(fit.pose.Q @ rotation((1.0, 0.0, 0.0), np.deg2rad(degrees)).T) < 2.5


def test_hinge_turns_alike_on_a_body_of_another_size() -> None:
    (_, one, _), (_, two, _) = laid(15.0, True), laid(15.0, True, scale=40.0)
    np.testing.assert_allclose(one.pose.Q, two.pose.Q, atol=1e-6)
    np.testing.assert_allclose(1600.0 * one.square, two.square, rtol=1e-4, atol=1e-8)


def test_one_piece_does_not_turn_its_end_and_lies_farther_from_a_bent_surface() -> None:
    piece, one, size = laid(15.0, False)
    np.testing.assert_allclose(one.pose.Q, I3, atol=1e-12)
    two = laid(15.0, True)[1]
    assert one.cost(piece.mass) > 4.0 * two.cost(piece.mass)
    assert two.cost(piece.mass) < (0.005 * size) ** 2


def test_one_piece_suffices_where_nothing_is_bent() -> None:
    piece, two, size = laid(0.0, True)
    assert angle(two.pose.Q) < 0.5
    assert two.cost(piece.mass) == pytest.approx(laid(0.0, False)[1].cost(piece.mass), rel=0.2, abs=(1e-4 * size) ** 2)


def test_a_point_off_the_surface_counts_no_more_than_the_bound() -> None:
    piece, fit, size = laid(90.0, False)
    assert fit.square.max() <= (0.02 * size) ** 2 * (1 + 1e-12)
    assert len(fit.square) == len(piece.V)


def test_a_tube_holds_a_shift_along_its_axis_and_a_turn_about_it_less_than_others() -> None:
    piece, fit, size = laid(0.0, False)
    body = chain((0.0, 2.0), np.tile(I3, (1, 3, 1, 1)), around=27, along=83)
    H = shift_stiffness(piece, fit, Target.of(body.x[0], body.F, size))
    np.testing.assert_allclose(H, H.T, atol=1e-12)
    turn, shift = np.diag(H)[:3], np.diag(H)[3:]
    # the cap at its end holds it along the axis, too
    assert shift[2] < 0.5 * shift[:2].min()
    assert turn[2] < 0.3 * turn[:2].min()


def test_what_no_match_holds_is_not_held() -> None:
    piece, fit, size = laid(0.0, False)
    body = chain((0.0, 2.0), np.tile(I3, (1, 3, 1, 1)))
    there = Target.of(body.x[0] + 100.0, body.F, size)
    assert shift_stiffness(piece, fit._replace(match=np.zeros(len(piece.V), np.int64)), there).max() < 1e-6
