"""Laws of the rigid residual: a rigid body is recognised, whatever its triangles and the errors of an alignment."""

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.paper_2014.rigid_residual import RigidResidualSettings, rigid_residual


def egg(turn: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A long body, its vertices' areas, its faces; other triangles for another turn."""
    body = trimesh.creation.icosphere(subdivisions=4)
    V = body.vertices @ Rotation.from_euler("xyz", [turn, 2 * turn, 3 * turn]).as_matrix().T * [1.0, 0.6, 3.0]
    body = trimesh.Trimesh(V, body.faces, process=False)
    area = np.bincount(body.faces.ravel(), np.repeat(body.area_faces / 3, 3), len(V))
    return V, area, np.asarray(body.faces, np.int64)


def bent(V: np.ndarray, degrees: float) -> np.ndarray:
    """Its upper end turned."""
    R = Rotation.from_euler("x", degrees, degrees=True).as_matrix()
    return np.where((V[:, 2] > 1.0)[:, None], (V - [0, 0, 1]) @ R.T + [0, 0, 1], V)


def test_other_triangles_and_a_slipping_alignment_are_no_motion() -> None:
    V, area, _ = egg(0.0)
    W, _, G = egg(0.4)
    R, t = Rotation.from_euler("xyz", [20, 50, -30], degrees=True).as_matrix(), [3.0, -1.0, 2.0]
    slipped = V + 0.15 * np.random.default_rng(0).normal(size=V.shape)
    assert rigid_residual(V, slipped @ R.T + t, area, W @ R.T + t, G) <= 1.0


def test_end_that_turns_is_motion_in_any_unit() -> None:
    V, area, F = egg(0.0)
    for scale in (1.0, 1500.0):
        x = scale * bent(V, 20)
        assert rigid_residual(scale * V, x, scale**2 * area, x, F) > 1.0


def test_bound_grows_with_the_noise_that_is_allowed() -> None:
    V, area, F = egg(0.0)
    x = bent(V, 20)
    residual = [rigid_residual(V, x, area, x, F, RigidResidualSettings(noise=noise, rounds=1)) for noise in (0.004, 0.4)]
    assert residual[1] < 1.0 < residual[0]
