"""Laws of where the root lies."""

import numpy as np

from kinetree.tasks.numerics.structure.root_place import root_amid_limbs

LEGS_AND_TRUNK = np.array([-1, 0, 0, 0, 1, 2, 3, 3])
"""Root, left thigh, right thigh, chest, left shank, right shank, left arm, right arm."""
JOINTS = np.random.default_rng(0).normal(size=(8, 3))
MIDDLE = np.array([7.0, 8.0, 9.0])


def test_root_lies_amid_the_limbs_that_hang_on_it() -> None:
    np.testing.assert_allclose(root_amid_limbs(JOINTS, LEGS_AND_TRUNK, MIDDLE), (JOINTS[1] + JOINTS[2]) / 2)


def test_root_that_nothing_but_limbs_hang_on_lies_amid_its_surface() -> None:
    star = np.array([-1, 0, 0, 0, 1, 2, 3])
    assert root_amid_limbs(JOINTS[:7], star, MIDDLE).tolist() == MIDDLE.tolist()


def test_root_that_one_limb_hangs_on_lies_amid_its_surface() -> None:
    tail_and_trunk = np.array([-1, 0, 0, 2, 2])
    assert root_amid_limbs(JOINTS[:5], tail_and_trunk, MIDDLE).tolist() == MIDDLE.tolist()
    assert root_amid_limbs(JOINTS[:1], np.array([-1]), MIDDLE).tolist() == MIDDLE.tolist()
