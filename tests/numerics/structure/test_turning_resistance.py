"""A part that is round about an axis slides along itself there, so that a joint off that axis shows."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shapes import open_cylinder, sphere

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.turning_resistance import FEWEST, turning_resistance

TUBE = open_cylinder(40, 60)
"""Radius 1, from z = 0 to 4."""


def resistance_at(place: tuple[float, float, float], V: Floats = TUBE[0], F: Ints = TUBE[1]) -> float:
    """Of a joint whose part is all of the surface; the part above has none."""
    parents, rest = np.array([-1, 0]), np.array([(0.0, 0.0, 0.0), place])
    return float(turning_resistance(V, F, np.ones(len(V), np.int64), parents, rest)[1])


def test_a_tube_turns_freely_about_its_axis_wherever_on_it_the_joint_lies() -> None:
    assert max(resistance_at((0.0, 0.0, z)) for z in (-1.0, 0.0, 2.0, 4.0)) < 1e-4


def test_the_farther_a_joint_lies_off_the_axis_of_its_part_the_more_is_resisted() -> None:
    off = [resistance_at((x, 0.0, 0.0)) for x in (0.0, 0.2, 0.5, 1.0)]
    assert off[0] < off[1] / 10
    assert off[1] < off[2] / 3
    assert off[2] < off[3] / 2


def test_a_sphere_turns_freely_about_its_middle() -> None:
    V, F = sphere(3)
    assert resistance_at((0.0, 0.0, 0.0), V, F) < 1e-4


def test_a_tube_with_corners_resists_where_a_round_one_slides() -> None:
    V, F = TUBE
    square = V.copy()
    square[:, :2] /= np.abs(V[:, :2]).max(axis=1, keepdims=True)
    assert resistance_at((0.0, 0.0, 0.0), square, F) > 100 * resistance_at((0.0, 0.0, 0.0))


def test_neither_size_nor_place_nor_pose_changes_it() -> None:
    place, turn, shift = np.array([0.4, 0.1, -0.3]), Rotation.from_rotvec([0.3, -1.0, 0.5]), np.array([5.0, -7.0, 2.0])
    V, F = TUBE
    there = resistance_at(tuple(30.0 * turn.apply(place) + shift), 30.0 * turn.apply(V) + shift, F)
    assert there == pytest.approx(resistance_at(tuple(place)))
    assert 0.0 < there < 1 / 3


def test_a_joint_has_the_smaller_resistance_of_its_two_parts() -> None:
    V, F = TUBE
    both, Fs = np.concatenate([V, V + (0.0, 0.0, 6.0)]), np.concatenate([F, F + len(V)])
    label, parents = np.repeat([0, 1], len(V)), np.array([-1, 0])
    on_one = np.array([(0.0, 0.0, 0.0), (0.5, 0.0, 5.0)])
    both[len(V) :, 0] += 0.5
    assert turning_resistance(both, Fs, label, parents, on_one)[1] < 1e-4


def test_nothing_is_known_of_the_root_and_of_a_joint_whose_parts_have_too_few_vertices() -> None:
    V, F = TUBE
    label, parents = np.full(len(V), -1), np.array([-1, 0, 1])
    label[: FEWEST - 1], label[-FEWEST:] = 1, 2
    known = turning_resistance(V, F, label, parents, np.zeros((3, 3)))
    assert np.isfinite(known).tolist() == [False, False, True]
