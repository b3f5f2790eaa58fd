"""Laws of a limb's last part in two pieces: the hinge holds them together, and skin goes with those that it follows."""

import numpy as np
import pytest
import trimesh
from limbs import rotation
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.hinged_piece import (
    BEND,
    POINTS,
    _bent,
    halves,
    laid_as_one,
    laid_hinged,
    motions,
    on_pieces,
    sampled_piece,
    turns_of_halves,
)
from kinetree.tasks.numerics.structure.piece_fit import Piece, PiecePose

V = np.random.default_rng(0).normal(size=(40, 3))
HINGE = np.array([0.1, -0.4, 0.3])
POSE = PiecePose(rotation((1.0, 2.0, 0.0), 0.7), np.array([3.0, 1.0, -2.0]), rotation((0.0, 1.0, 1.0), 0.5))
R, T = motions(POSE, HINGE)
ONES = np.ones(len(V))


def test_both_pieces_carry_the_hinge_to_one_place() -> None:
    near, far = (R[k] @ HINGE + T[k] for k in (0, 1))
    np.testing.assert_allclose(near, far, atol=1e-12)
    np.testing.assert_allclose(R[0].T @ R[1], POSE.Q, atol=1e-12)


def test_skin_goes_with_the_piece_that_has_it() -> None:
    x = np.full_like(V, 9.0)
    np.testing.assert_allclose(on_pieces(V, x, ONES, 0 * ONES, R, T), V @ R[0].T + T[0], atol=1e-12)
    np.testing.assert_allclose(on_pieces(V, x, ONES, ONES, R, T), V @ R[1].T + T[1], atol=1e-12)


def test_skin_that_does_not_follow_the_part_stays_where_it_is_aligned() -> None:
    x = V + 0.5
    np.testing.assert_array_equal(on_pieces(V, x, 0 * ONES, ONES, R, T), x)


def test_between_the_pieces_skin_lies_between() -> None:
    x = np.full_like(V, 9.0)
    ends = [on_pieces(V, x, ONES, s * ONES, R, T) for s in (0.0, 1.0)]
    np.testing.assert_allclose(on_pieces(V, x, ONES, 0.25 * ONES, R, T), 0.75 * ends[0] + 0.25 * ends[1], atol=1e-12)


def test_a_large_part_is_sampled_and_its_points_weigh_by_the_square_of_what_they_follow() -> None:
    many, weight = np.tile(V, (50, 1)), np.linspace(0.0, 1.0, 50 * len(V))
    piece = sampled_piece(many, many, weight, weight > 0.5, HINGE, HINGE)
    assert POINTS <= len(piece.V) < 2 * POINTS
    np.testing.assert_allclose(piece.mass[1:], weight[:: len(many) // POINTS][1:] ** 2)
    assert len(sampled_piece(V, V, ONES, ONES > 0.5, HINGE, HINGE).V) == len(V)


def test_points_of_a_sample_lie_one_after_the_other() -> None:
    many = np.tile(V, (50, 1))
    piece = sampled_piece(many, many, np.ones(len(many)), np.ones(len(many), np.bool_), HINGE, HINGE)
    assert all(a.flags.c_contiguous for a in (piece.V, piece.N, piece.mass, piece.far))  # one type for what is compiled


def test_halves_share_what_is_near_and_divide_what_lies_beyond() -> None:
    points, weight = np.random.default_rng(1).normal(size=(201, 3)), np.linspace(0.1, 1.0, 201)
    far = points[:, 0] > 0.3
    piece = sampled_piece(points, -points, weight, far, HINGE, HINGE)
    both = halves(piece)
    for half in both:
        np.testing.assert_array_equal(half.V[~half.far], points[~far])
        np.testing.assert_array_equal(half.mass[~half.far], piece.mass[~far])
        np.testing.assert_array_equal(half.N, -half.V)
        assert all(a.flags.c_contiguous for a in (half.V, half.N, half.mass, half.far))
    for side, half in enumerate(both):
        np.testing.assert_array_equal(half.V[half.far], points[far][side::2])
        np.testing.assert_array_equal(half.mass[half.far], 2.0 * piece.mass[far][side::2])


def test_each_half_turns_as_its_own_points_lie() -> None:
    grid = np.linspace(-1.0, 1.0, 9)
    V = np.array([[x, y, z] for z in (-1.0, 1.0) for x in grid for y in grid])
    N, far = np.tile([0.0, 0.0, 1.0], (len(V), 1)), V[:, 2] > 0.0
    piece, still = Piece(V, N, np.ones(len(V)), far, np.zeros(3), np.zeros(3)), PiecePose(np.eye(3), np.zeros(3), np.eye(3))
    sheet = np.array([[x, y, z] for z in (-1.0, 1.0) for x in np.linspace(-2, 2, 41) for y in np.linspace(-2, 2, 41)])
    i, j = np.arange(41 * 40) // 40, np.arange(41 * 40) % 40
    a = (41 * i + j)[i < 40]
    one = np.concatenate([np.stack([a, a + 41, a + 1], 1), np.stack([a + 1, a + 41, a + 42], 1)])
    F, top = np.concatenate([one, one + 41 * 41]), sheet[:, 2] > 0.0
    for angle in (0.0, 0.2):
        x = sheet.copy()
        x[top] = sheet[top] @ rotation((1.0, 0.0, 0.0), angle).T
        first, second = halves(piece)
        back = rotation((1.0, 0.0, 0.0), -0.1)
        second = second._replace(V=np.where(second.far[:, None], second.V @ back.T, second.V))
        turns = turns_of_halves((first, second), still, np.zeros(3), Target.of(x, F, 10.0))
        assert np.arccos([Q[2, 2] for Q in turns]) == pytest.approx([angle, angle + 0.1], abs=0.01)


AT = np.array([3.0, -1.0, 2.0])
"""Where the foot's hinge lies."""
TURNED = rotation((1.0, 2.0, -1.0), 1.1)
"""How the foot's surface is turned in a frame."""


def foot(angle: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, normals and faces of an upright block and a flat one before it, bent up about x; which are of the flat one."""
    V, N, F = [], [], []
    for size, middle, turn in (((2.0, 4.0, 3.0), -2.0, 0.0), ((2.0, 2.0, 0.5), 1.0, angle)):
        block = trimesh.creation.box(size)
        v, f = block.vertices, block.faces
        for _ in range(4):
            v, f = trimesh.remesh.subdivide(v, f)
        F.append(f + sum(len(other) for other in V))
        R = rotation((1.0, 0.0, 0.0), turn)
        N.append(trimesh.Trimesh(v, f, process=False).vertex_normals @ R.T)
        V.append((v + [0.0, middle, 0.0]) @ R.T + AT)
    return np.concatenate(V), np.concatenate(N), np.concatenate(F), np.arange(len(V[0]) + len(V[1])) >= len(V[0])


def toes(angle: float, turn: np.ndarray | None, is_bent: bool) -> tuple[float, float]:
    """By how much the toe of a foot is found turned up, radian, and what is left, share of what is left as one piece."""
    V, N, _, far = foot(0.0)
    piece = sampled_piece(V, N, np.ones(len(V)), far, AT, AT + [0.0, -4.0, 0.0])
    x, _, F, _ = foot(angle)
    target, heel = Target.of(x @ TURNED.T, F, 8.0), TURNED @ piece.joint
    one = laid_as_one(piece, PiecePose(TURNED, np.zeros(3), np.eye(3)), heel, target)
    fit = laid_hinged(piece, one, heel, target, turn, is_bent=is_bent)
    return float(Rotation.from_matrix(fit.pose.Q).as_rotvec()[0]), fit.two / fit.one


def test_a_toe_that_turns_far_is_found_only_from_a_bent_hinge() -> None:
    for angle in (-1.0, 1.0):
        straight, bent = (toes(angle, None, is_bent) for is_bent in (False, True))
        assert abs(straight[0]) < 0.3
        assert bent[0] == pytest.approx(angle, abs=0.05)
        assert bent[1] < 0.1 * straight[1]


def test_the_turn_of_another_frame_counts_whether_hinges_are_bent_or_not() -> None:
    near = rotation((1.0, 0.0, 0.0), 1.6)
    assert abs(toes(1.7, None, True)[0]) < 1.0
    assert all(toes(1.7, near, is_bent)[0] == pytest.approx(1.7, abs=0.05) for is_bent in (False, True))


def test_a_hinge_that_does_not_turn_stays_whether_bent_or_not() -> None:
    assert toes(0.0, None, False) == toes(0.0, None, True)


def test_a_hinge_is_bent_from_its_turn_about_the_axis_along_which_the_far_piece_is_wide() -> None:
    V, N, _, far = foot(0.0)
    turned = sampled_piece(V @ TURNED.T, N @ TURNED.T, np.ones(len(V)), far, TURNED @ AT, TURNED @ AT)
    Q = rotation((0.0, 1.0, 1.0), 0.5)
    angles = [Rotation.from_matrix(Q.T @ turn).as_rotvec() for turn in _bent(turned, Q)]
    assert sorted(float(angle @ TURNED[:, 0]) for angle in angles) == pytest.approx([-BEND, BEND], abs=0.01)
    assert [float(np.linalg.norm(angle)) for angle in angles] == pytest.approx([BEND, BEND])
    assert _bent(turned._replace(far=np.zeros(len(turned.far), np.bool_)), Q) == ()
