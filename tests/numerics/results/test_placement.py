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


@pytest.mark.parametrize("up", UP_ROTATIONS)
@pytest.mark.parametrize("degrees", [0, 40, 50, 130, 200, 300])
def test_front_comes_within_an_eighth_of_a_turn_of_where_programs_look_for_it(up, degrees):
    angle = np.radians(degrees)
    front = np.linalg.inv(upright_rotation(up)) @ [np.sin(angle), 0, np.cos(angle)]
    for wanted, ahead in (("y", [0, 0, 1]), ("z", [0, -1, 0])):
        Q = upright_rotation(up, wanted, front)
        assert (Q @ front) @ ahead >= np.cos(np.pi / 4) - 1e-9
        np.testing.assert_array_equal(np.abs(Q).sum(axis=0), 1.0)
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
