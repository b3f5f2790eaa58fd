"""Laws of joint-angle curves and forward kinematics, on a hinge whose positions are known."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.input.synth.descriptions import Curve
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.motion import (
    curve_values,
    forward_kinematics,
    joint_rotations,
    true_joints,
    turning_angles,
)

X = (1.0, 0.0, 0.0)


def hinge(**curves):
    joints = [
        {"name": "root", "position": [0, 0, 0], "radius": 0.5},
        {"name": "knee", "parent": "root", "position": [0, 0, 2], "radius": 0.5},
        {"name": "foot", "parent": "knee", "position": [0, 0, 3], "radius": 0.5},
        {"name": "toe", "parent": "foot", "position": [0, 0, 5], "radius": 0.5},
    ]
    return Figure.of({"name": "hinge", "joints": joints, "motions": {"bend": curves}})


def posed(figure, seconds):
    R, shift = joint_rotations(figure, figure.motion(None), np.asarray(seconds, dtype=float))
    return R, *forward_kinematics(figure.rest, figure.parents, R, shift)


def test_a_sine_curve_swings_about_its_offset_with_its_period_and_phase():
    curve = Curve(X, 30.0, 0.5, 0.25, 10.0, (), False)
    np.testing.assert_allclose(curve_values(curve, np.array([0.0, 0.5, 1.0, 2.0])), [40.0, 10.0, -20.0, 40.0], atol=1e-12)


def test_key_frames_are_met_and_held_and_never_overshot():
    curve = Curve(X, 0.0, 1.0, 0.0, 0.0, ((1.0, 5.0), (2.0, 9.0), (4.0, 9.0)), False)
    np.testing.assert_allclose(curve_values(curve, np.array([0.0, 1.0, 2.0, 4.0, 7.0])), [5, 5, 9, 9, 9])
    between = curve_values(curve, np.linspace(0.0, 5.0, 101))
    assert between.min() >= 5.0
    assert between.max() <= 9.0 + 1e-12


def test_keys_with_a_period_repeat_and_rest_at_every_key_on_the_way_of_least_jerk():
    curve = Curve(X, 0.0, 1.0, 0.0, 3.0, ((0.5, 0.0), (1.0, 10.0)), False, period=2.0)
    np.testing.assert_allclose(curve_values(curve, np.array([0.5, 1.0, 2.5, 3.0, -1.0])), [3.0, 13.0, 3.0, 13.0, 13.0])
    # 10/32 − 15/256 … at a quarter and the half of the way: 10u³ − 15u⁴ + 6u⁵
    np.testing.assert_allclose(curve_values(curve, np.array([0.625, 0.75, 1.75])), [3.0 + 1.03515625, 8.0, 8.0])
    for key in (0.5, 1.0):
        around = curve_values(curve, key + np.array([-1e-3, 0.0, 1e-3]))
        assert np.abs(np.diff(around)).max() < 1e-4


def test_a_knee_bent_by_a_right_angle_moves_only_what_hangs_on_it():
    quarter = {"axis": [1, 0, 0], "amplitude": 0, "offset": 90}
    _, positions, _ = posed(hinge(knee=[quarter]), [0.0])
    np.testing.assert_allclose(positions[0], [[0, 0, 0], [0, 0, 2], [0, -1, 2], [0, -3, 2]], atol=1e-12)


def test_a_root_that_slides_takes_every_joint_along():
    slide = {"axis": [0, 1, 0], "distance": 0, "offset": 3}
    figure = hinge(root=[slide])
    _, positions, _ = posed(figure, [0.0])
    np.testing.assert_allclose(positions[0], figure.rest + np.array([0, 3, 0]))


def test_the_first_curve_of_a_joint_is_the_outermost():
    tilt = {"axis": [1, 0, 0], "amplitude": 0, "offset": 90}
    spin = {"axis": [0, 0, 1], "amplitude": 0, "offset": 90}
    _, _, G = posed(hinge(knee=[spin, tilt]), [0.0])
    expected = Rotation.from_euler("ZX", [90, 90], degrees=True).as_matrix()
    np.testing.assert_allclose(G[0, 1], expected, atol=1e-12)


def test_a_swing_of_an_amplitude_turns_by_twice_it_against_the_parent_alone():
    swing = {"axis": [0.6, 0.8, 0.0], "amplitude": 25, "frequency": 1.0}
    figure = hinge(root=[{"axis": [0, 0, 1], "amplitude": 80}], foot=[swing])
    R, _, _ = posed(figure, [0.0, 0.25, 0.5, 0.75])
    assert turning_angles(R) == pytest.approx([160.0, 0.0, 50.0, 0.0], abs=1e-4)


def test_a_joint_that_does_not_turn_joins_its_parents_part_and_the_root_is_not_scored():
    figure = hinge(root=[{"axis": [0, 0, 1], "amplitude": 80}], foot=[{"axis": [1, 0, 0], "amplitude": 7}])
    R, _, _ = posed(figure, np.linspace(0.0, 1.0, 9))
    joints, parts = true_joints(figure, R)
    assert parts == [["root", "knee"], ["foot"]]
    assert [joint["part"] for joint in joints] == [0, 0, 1, None]
    assert [joint["scored"] for joint in joints] == [False] * 4
    assert joints[2]["turns_deg"] == pytest.approx(14.0)
    assert joints[3] == {"name": "toe", "parent": "foot", "kind": "tip", "turns_deg": 0.0, "scored": False, "part": None}
