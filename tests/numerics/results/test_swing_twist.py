"""Laws of swing and twist."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.results.swing_twist import swing_twist


@pytest.mark.parametrize("angle", [-179.0, -90.0, 0.0, 30.0, 180.0])
def test_turn_about_the_bone_is_twist_alone(angle):
    R = Rotation.from_rotvec([[0.0, np.radians(angle), 0.0]]).as_matrix()
    np.testing.assert_allclose(swing_twist(R), [[0.0, angle, 0.0]], atol=1e-9)


def test_swing_after_twist_gives_the_rotation_back_and_the_bone_knows_no_twist():
    R = Rotation.random(50, random_state=0)
    parts = np.radians(swing_twist(R.as_matrix()))
    swing, twist = Rotation.from_rotvec(parts * (1, 0, 1)), Rotation.from_rotvec(parts * (0, 1, 0))
    np.testing.assert_allclose((swing * twist).as_matrix(), R.as_matrix(), atol=1e-9)
    np.testing.assert_allclose(swing.apply([0, 1, 0]), R.apply([0, 1, 0]), atol=1e-9)


def test_swings_have_their_signs():
    R = Rotation.from_euler("xz", [[20, 0], [0, -35]], degrees=True).as_matrix()
    np.testing.assert_allclose(swing_twist(R), [[20, 0, 0], [0, 0, -35]], atol=1e-9)
