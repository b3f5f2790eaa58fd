"""Laws of inside: balls, hollow balls, lines through them."""

import numpy as np
import pytest
import trimesh
from limbs import rotation

from kinetree.tasks.numerics.geometry.inside import crossed, depth_along, inside

BALL = trimesh.creation.icosphere(3)
V, F = np.array(BALL.vertices), np.array(BALL.faces)


@pytest.mark.parametrize("seed", range(3))
def test_points_of_a_ball_are_inside(seed: int) -> None:
    P = np.random.default_rng(seed).normal(size=(200, 3))
    r = np.linalg.norm(P, axis=1)
    clear = np.abs(r - 1.0) > 0.02
    R = rotation((1.0, 2.0, 0.5), 0.3 + seed)
    assert np.array_equal(inside(P @ R.T, V @ R.T, F)[clear], r[clear] < 1.0)


def test_hollow_is_outside() -> None:
    both = np.concatenate([V, 0.5 * V])
    faces = np.concatenate([F, F[:, ::-1] + len(V)])
    assert inside(np.array([[0.0, 0.0, 0.0], [0.75, 0.1, 0.0]]), both, faces).tolist() == [False, True]


def test_lines_that_leave_the_ball_cross_it_and_chords_within_do_not() -> None:
    A, B = np.zeros((2, 3)), np.array([[2.0, 0.1, 0.2], [0.5, 0.1, 0.2]])
    assert crossed(A, B, V, F).tolist() == [True, False]


def test_depth_is_the_distance_to_the_surface_behind() -> None:
    depth = depth_along(np.array([[0.97, 0.01, 0.02]]), np.array([[-1.0, 0.0, 0.0]]), V, F, 1e-6)
    assert depth[0] == pytest.approx(1.97, abs=0.02)


@pytest.mark.parametrize("seed", range(20))
def test_lines_through_edges_do_not_slip_between_faces(seed: int) -> None:
    """A wall of two faces, seen along lines through the edge between them, turned at random."""
    Q = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    wall = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]])
    faces = np.array([[0, 2, 3], [1, 3, 2]])
    start = np.stack([np.zeros(9), np.zeros(9), np.linspace(-0.8, 0.8, 9)], axis=1)
    depth = depth_along(start @ Q.T, np.tile(Q[:, 0], (9, 1)), wall @ Q.T, faces, 0.0)
    np.testing.assert_allclose(depth, 1.0, rtol=1e-9)
