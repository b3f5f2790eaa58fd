"""The 2009 paper's measures on examples counted by hand."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.evaluation.rates import detection_rate, nearest_distance

LINE = np.array([[[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0], [3.0, 0, 0]]])


def test_same_joints_are_all_detected_at_no_distance():
    assert detection_rate(LINE, LINE).tolist() == [1.0]
    assert nearest_distance(LINE, LINE).tolist() == [0.0]


def test_node_that_is_nearest_to_two_joints_detects_one():
    """A node at 0.2 is nearest to joints 0 and 1, one at 3 to joints 2 (at distance 1) and 3."""
    joints = np.array([[[0.2, 0, 0], [3.0, 0, 0]]])
    assert detection_rate(joints, LINE).tolist() == [0.5]
    assert nearest_distance(joints, LINE) == pytest.approx([(0.2 + 0.8 + 1.0 + 0.0) / 4])


def test_redundant_node_costs_nothing_here():
    more = np.concatenate([LINE, [[[50.0, 0, 0]]]], axis=1)
    assert detection_rate(more, LINE).tolist() == [1.0]


def test_frames_are_told_one_by_one():
    two = np.concatenate([LINE, LINE + [0, 0.3, 0]])
    assert nearest_distance(two, np.concatenate([LINE, LINE])) == pytest.approx([0.0, 0.3])
