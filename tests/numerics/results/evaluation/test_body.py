"""A cylinder that is carried, measured and met by points."""

import numpy as np
import pytest
import shapes

from kinetree.tasks.numerics.results.evaluation.body import (
    blended_skin,
    joints_fit,
    local_radii,
    longest_side,
    nearest_vertices,
    share_inside,
)

V, _ = shapes.open_cylinder(32, 41, radius=0.5, height=4.0)
TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def test_surface_of_one_rigid_part_is_turned_about_its_joint():
    influence, weight = np.zeros((len(V), 4), np.int32), np.eye(4)[:1].repeat(len(V), axis=0)
    rest, x = np.array([[0.0, 0, 1]]), np.array([[5.0, 0, 1]])
    posed = blended_skin(V, influence, weight, rest, TURN[None], x)
    assert posed == pytest.approx((V - rest) @ TURN.T + x)


def test_half_followed_joints_meet_in_the_middle():
    influence, weight = np.tile([0, 1, 0, 0], (len(V), 1)), np.tile([0.5, 0.5, 0.0, 0.0], (len(V), 1))
    still = np.tile(np.eye(3), (2, 1, 1))
    posed = blended_skin(V, influence, weight, np.zeros((2, 3)), still, np.array([[0.0, 0, 0], [2.0, 0, 0]]))
    assert posed == pytest.approx(V + [1.0, 0, 0])


def test_half_the_diameter_on_the_axis_is_the_radius():
    axis = np.array([[0.0, 0, 1], [0, 0, 2.05], [0, 0, 3]])
    assert local_radii(V, axis) == pytest.approx(np.full(3, 0.5), rel=0.01)


def test_box_of_the_cylinder():
    assert longest_side(V) == pytest.approx(4.0)
    assert share_inside(V, np.array([[0.0, 0, 2], [0, 0, 400]]), 0.1) == 0.5
    assert share_inside(V, np.array([[0.0, 0, 4.3]]), 0.1) == 1.0


def test_every_vertex_is_nearest_to_itself():
    assert np.array_equal(nearest_vertices(V, V[::7]), np.arange(len(V))[::7])


def test_joints_fit_a_body_in_its_own_unit_and_place_alone():
    axis = np.array([[0.0, 0, 0.5], [0, 0, 2], [0, 0, 3.5], [0, 0, 9]])
    assert joints_fit(V, axis[:3])
    assert joints_fit(V, axis)
    assert not joints_fit(V, axis[:3] / 1000)
    assert not joints_fit(V, axis[:3] * 1000)
    assert not joints_fit(V, axis[:3] + [8, 0, 0])
