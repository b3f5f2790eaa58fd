"""A long part's axis says where its joint is expected."""

import numpy as np
import pytest
from limbs import tube

from kinetree.tasks.numerics.structure.axes import SHARE, towards_axes

EXPECTED = np.array([[0.5, 0.3, -2.0], [0.1, 0.0, 2.0]])


def expected(parents: list[int], radius: float = 1.0, stretch: float = 1.0) -> np.ndarray:
    """Three parts: the middle one a tube about z, between borders that were seen to one side of it."""
    V, _ = tube(around=20, along=60)
    V = V / [1.0, 1.0, np.ptp(V[:, 2]) / 12.0]
    r = np.hypot(V[:, 0], V[:, 1]).max()
    V = V * [1 / r, 1 / r, stretch]
    label = np.where(V[:, 2] < -4 * stretch, 0, np.where(V[:, 2] < 4 * stretch, 1, 2))
    return towards_axes(V, np.ones(len(V)), label, np.eye(3)[label], np.array(parents), EXPECTED, np.full(2, radius))


def test_joint_of_a_long_part_is_expected_nearer_to_its_axis() -> None:
    found = expected([-1, 0, 1])
    assert found[0] == pytest.approx(EXPECTED[0] * [1 - SHARE, 1 - SHARE, 1.0], abs=1e-6)
    assert found[1] == pytest.approx(EXPECTED[1])


def test_a_part_on_which_nothing_or_much_hangs_says_nothing() -> None:
    assert expected([-1, 0, 0]) == pytest.approx(EXPECTED)


def test_a_short_part_and_an_axis_far_from_the_border_say_nothing() -> None:
    assert expected([-1, 0, 1], stretch=0.2) == pytest.approx(EXPECTED)
    assert expected([-1, 0, 1], radius=0.3) == pytest.approx(EXPECTED)
