"""Laws of the distance between the skinned mesh and the input mesh."""

import numpy as np
import pytest
import trimesh

from kinetree.tasks.numerics.results.surface_error import SurfaceError, surface_error

BALL = trimesh.creation.icosphere(subdivisions=3)
V, F = np.array(BALL.vertices), np.array(BALL.faces)
HALF = (V[:, 0] > 0).astype(np.int64)
"""Two parts."""
CENTRES = np.array([[-0.4, 0.0, 0.0], [0.4, 0.0, 0.0]])


def of(skin: np.ndarray = V, joints: np.ndarray = CENTRES, surface: np.ndarray = V, faces: np.ndarray = F) -> SurfaceError:
    return surface_error(skin, F, HALF, joints, surface, faces)


def test_a_skin_that_is_the_surface_is_nowhere_away_and_its_joints_are_inside() -> None:
    error = of()
    for values in error:
        np.testing.assert_allclose(values, 0.0, atol=1e-12)


def test_only_the_part_that_is_moved_away_is_away() -> None:
    error = of(skin=V + 0.5 * np.outer(HALF, [1.0, 0.0, 0.0]))
    assert error.skin[0] == pytest.approx(0.0, abs=1e-9)
    assert 0.2 < error.skin[1] < 0.5


def test_surface_that_the_skin_lacks_counts_for_the_part_it_is_nearest_to() -> None:
    bump = V * np.where(V[:, :1] > 0.9, 1.5, 1.0)
    error = of(surface=bump)
    assert error.surface[1] > 0.05
    assert error.surface[0] == pytest.approx(0.0, abs=1e-9)


def test_a_joint_is_as_far_outside_as_it_is_from_the_surface() -> None:
    error = of(joints=np.array([[-0.4, 0.0, 0.0], [1.25, 0.0, 0.0]]))
    assert error.outside[0] == 0.0
    assert error.outside[1] == pytest.approx(0.25, abs=0.02)


def test_distances_grow_with_the_body() -> None:
    moved, joints = V + [0.3, 0, 0], CENTRES + [1.0, 0, 0]
    once, thrice = of(moved, joints), of(3 * moved, 3 * joints, 3 * V)
    for small, large in zip(once, thrice, strict=True):
        np.testing.assert_allclose(large, 3 * small, atol=1e-9)


def test_a_part_without_surface_is_not_away() -> None:
    error = surface_error(V, F, 0 * HALF, CENTRES, V + [0.2, 0, 0], F)
    assert error.skin[0] > 0.0
    assert (error.skin[1], error.surface[1]) == (0.0, 0.0)
