"""Each constant of an evaluation decides what it says, and nothing decides it elsewhere."""

import numpy as np
import pytest
import shapes

from kinetree.tasks.numerics.results.evaluation.body import joints_fit
from kinetree.tasks.numerics.results.evaluation.rignet import chamfer
from kinetree.tasks.numerics.results.evaluation.settings import EvaluationSettings
from kinetree.tasks.numerics.results.evaluation.split_joints import split_joints
from kinetree.tasks.numerics.results.evaluation.tree_match import tree_match_distance

V, _ = shapes.open_cylinder(32, 41, radius=0.5, height=4.0)
AXIS = np.array([[0.0, 0, 0.5], [0, 0, 2], [0, 0, 3.5]])


@pytest.mark.parametrize(
    ("points", "change"),
    [
        (AXIS + [0.8, 0, 0], {"box_margin": 0.01}),
        (AXIS + [[0, 0, 0], [9, 0, 0], [0, 0, 0]], {"least_inside": 0.7}),
        (AXIS * [1, 1, 0.5], {"least_span": 0.4}),
    ],
)
def test_joints_that_fit_do_not_fit_under_a_stricter_limit(points, change):
    assert joints_fit(V, points)
    assert not joints_fit(V, points, EvaluationSettings(**change))


def test_wider_deviation_keeps_a_joint_whole():
    Y = np.zeros((2, 4, 3))
    Y[:, 2], Y[:, 3] = [0, 0, 1], [[0, 0, 2], [0, 0.1, 2]]
    tree = (-1, 0, 1, 1)
    assert len(split_joints(Y, tree, [False] * 4, 1.0).parents) == 5
    assert len(split_joints(Y, tree, [False] * 4, 1.0, EvaluationSettings(rigid_deviation=0.2)).parents) == 4


def test_coarser_points_on_bones_change_their_distance():
    X, Y = np.array([[[0.0, 0, 0], [1, 0, 0]]]), np.array([[[0.0, 0.1, 0], [0.6, 0.5, 0]]])
    fine = chamfer(X, (-1, 0), Y, (-1, 0), 1.0)
    coarse = chamfer(X, (-1, 0), Y, (-1, 0), 1.0, EvaluationSettings(bone_step=1.0))
    assert fine[:2] == coarse[:2]
    assert fine.b2b != coarse.b2b


def test_joints_at_one_place_keep_their_pairs_where_too_many_would_be_permuted():
    star = (-1, 0, 0, 0, 1, 2, 3)
    pairs, place = [(1, 2), (2, 3), (3, 1), (4, 4), (5, 5), (6, 6)], [0, 9, 9, 9, 4, 5, 6]
    assert tree_match_distance(star, star, pairs, place) == 0
    assert tree_match_distance(star, star, pairs, place, EvaluationSettings(most_permuted=2)) > 0
