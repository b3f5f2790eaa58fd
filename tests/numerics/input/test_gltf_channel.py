"""Laws of glTF channels: at a key they have its value, between keys they go as their interpolation says."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from kinetree.tasks.numerics.input.gltf_channel import Channel, rotation_matrix

TIMES = np.array([0.0, 1.0, 3.0])
PLACES = np.array([[0.0, 0, 0], [1, 2, 0], [0, 2, 5]])


@pytest.mark.parametrize("way", ["LINEAR", "STEP"])
def test_channel_has_the_value_of_each_key_and_stays_outside(way):
    channel = Channel(0, "translation", TIMES, PLACES, way)
    for t, place in zip((-1.0, *TIMES, 9.0), PLACES[[0, 0, 1, 2, 2]], strict=True):
        np.testing.assert_allclose(channel.at(t), place)


def test_steps_wait_and_lines_do_not():
    np.testing.assert_allclose(Channel(0, "translation", TIMES, PLACES, "STEP").at(2.0), PLACES[1])
    np.testing.assert_allclose(Channel(0, "translation", TIMES, PLACES, "LINEAR").at(2.0), (PLACES[1] + PLACES[2]) / 2)


def test_cubic_spline_through_points_of_a_line_with_its_slope_is_the_line():
    slope = np.array([2.0, 0, -1])
    values = np.stack([np.tile(slope, (3, 1)), np.outer(TIMES, slope), np.tile(slope, (3, 1))], axis=1)
    channel = Channel(0, "translation", TIMES, values, "CUBICSPLINE")
    for t in (0.3, 1.0, 2.2):
        np.testing.assert_allclose(channel.at(t), t * slope, atol=1e-12)


def test_rotations_are_those_of_scipy_on_the_shorter_way():
    R = Rotation.random(3, random_state=4)
    q = R.as_quat() * np.array([[1], [-1], [1]])
    channel = Channel(0, "rotation", TIMES, q, "LINEAR")
    for t in (0.0, 0.4, 1.7, 2.9):
        np.testing.assert_allclose(rotation_matrix(channel.at(t)), Slerp(TIMES, R)(t).as_matrix(), atol=1e-9)
