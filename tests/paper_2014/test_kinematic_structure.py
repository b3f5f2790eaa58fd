"""Contract of the kinematic structure: a skeleton as every method leaves it."""

import numpy as np
import pytest
from mesoscopic import leaf_vertices, mesoscopic

from kinetree.pipeline import views


def test_three_arms_are_children_of_the_middle_and_end_at_their_leaves() -> None:
    here = mesoscopic()
    skeleton = here.skeleton
    assert skeleton.kinds.count("joint") == 3
    assert skeleton.kinds.count("leaf") == 3
    assert [skeleton.parents[j] for j, kind in enumerate(skeleton.kinds) if kind == "joint"] == [0, 0, 0]
    for vertex in leaf_vertices(here.body):
        ends = skeleton.positions[:, [kind == "leaf" for kind in skeleton.kinds]]
        distance = np.linalg.norm(ends - here.body.x[: len(ends), [vertex]], axis=2).max(axis=0)
        assert distance.min() < 1.0


def test_lengths_are_fixed_and_degrees_are_those_of_the_arms() -> None:
    skeleton = mesoscopic().skeleton
    for j, p in enumerate(skeleton.parents):
        if p >= 0:
            length = np.linalg.norm(skeleton.positions[:, j] - skeleton.positions[:, p], axis=1)
            assert length == pytest.approx(skeleton.lengths[j])
    assert all(60 < d < 110 for d, kind in zip(skeleton.degrees, skeleton.kinds, strict=True) if kind == "joint")
    assert skeleton.confidence.min() > 0.9


def test_body_at_rest_has_no_joint() -> None:
    skeleton = mesoscopic(at_rest=True).skeleton
    assert skeleton.kinds == ("root", "leaf", "leaf", "leaf")
    assert "no joints" in views.remarks(skeleton)[0]
