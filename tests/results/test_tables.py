"""The CSV tables."""

import csv
import io

import numpy as np
import pytest
from results.rigged_bodies import spider

from kinetree.pipeline import views
from kinetree.tasks.results.formats.tables import bone_angles
from kinetree.tasks.results.tables import tables


@pytest.fixture
def body():
    return spider()


def rows(skeleton, name):
    return list(csv.reader(io.StringIO(views.files(tables(skeleton), ())[f"tables/{name}.csv"].decode(), newline="")))


def test_trajectories_are_a_row_a_frame_with_its_time(body):
    head, *values = rows(body, "positions")
    assert head[:5] == ["frame", "seconds", "trunk.x", "trunk.y", "trunk.z"]
    numbers = np.array(values, dtype=float)
    np.testing.assert_array_equal(numbers[:, 0], body.frames)
    np.testing.assert_allclose(numbers[:, 1], np.arange(12) / 10)
    np.testing.assert_allclose(numbers[:, 2:].reshape(body.positions.shape), body.positions, rtol=1e-8, atol=1e-7)


def test_time_is_empty_where_nobody_knows_it():
    assert {row[1] for row in rows(spider(fps=None), "angles")[1:]} == {""}


def test_confidence_is_told_of_every_joint(body):
    head, *values = rows(body, "confidence")
    assert head[2:] == list(body.names)
    assert {value for row in values for value in row[2:]} == {"0.75"}


def test_bones_have_their_length_and_unit(body):
    head, *values = rows(body, "bones")
    assert head == ["parent", "child", "length", "unit"]
    assert values[0] == ["trunk", "arm", "4", "mm"]
    assert len(values) == 6


def test_angle_is_180_in_line_90_at_a_right_angle_and_0_folded(body):
    X = np.zeros((4, 7, 3))
    X[:, 1] = [1, 0, 0]
    X[:, 2] = [[2, 0, 0], [1, 1, 0], [0.5, 0, 0], [1, 0, -3]]
    X[:, 4:] = np.eye(3)
    few = {"rotation": body.rotation[:4], "confidence": body.confidence[:4], "frames": (0, 1, 2, 3)}
    pairs, angles = bone_angles(spider(positions=X, **few))
    assert pairs == [(0, 1, 2), (0, 4, 5), (0, 4, 6)]
    np.testing.assert_allclose(angles[:, 0], [180, 90, 0, 90], atol=1e-9)


def test_angles_are_named_by_their_three_joints(body):
    assert rows(body, "angles")[0][2:] == ["trunk/arm/hand", "trunk/knee/foot", "trunk/knee/spur"]


def test_names_with_commas_quotes_and_line_ends_stay_one_cell():
    names = ("a,b", 'c"d', "e\nf", "é", "<script>", " ", "g;h")
    assert rows(spider(names=names), "confidence")[0][2:] == list(names)
