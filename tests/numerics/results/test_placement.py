"""Laws of bringing a body upright, and the unit guessed from its size."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.placement import UP_ROTATIONS, guessed_metres, upright_rotation


@pytest.mark.parametrize("up", UP_ROTATIONS)
@pytest.mark.parametrize("wanted", ["y", "z"])
def test_up_comes_to_the_axis_that_is_wanted_and_nothing_is_mirrored(up, wanted):
    Q = upright_rotation(up, wanted)
    along = np.zeros(3)
    along["xyz".index(up[-1])] = -1.0 if up[0] == "-" else 1.0
    np.testing.assert_array_equal(Q @ along, np.eye(3)["xyz".index(wanted)])
    assert np.linalg.det(Q) == pytest.approx(1.0)


def test_axis_that_is_up_already_stays():
    for axis in ("y", "z"):
        np.testing.assert_array_equal(upright_rotation(axis, axis), np.eye(3))


@pytest.mark.parametrize("metres", [1.0, 0.01, 0.001])
@pytest.mark.parametrize("size", [0.4, 1.0, 1.75, 2.4])
def test_unit_of_people_and_animals_is_guessed(size, metres):
    assert guessed_metres(size / metres) == metres


def test_body_without_size_keeps_its_unit():
    assert guessed_metres(0.0) == 1.0
