"""Contract of the kinematic structure: a skeleton as every method leaves it."""

import numpy as np
import pytest
from mesoscopic import made, tips

from kinetree.pipeline import views


def test_three_arms_hang_on_the_middle_and_end_at_their_leaves() -> None:
    here = made()
    told = here.skeleton
    assert told.kinds.count("joint") == 3
    assert told.kinds.count("leaf") == 3
    assert [told.parents[j] for j, kind in enumerate(told.kinds) if kind == "joint"] == [0, 0, 0]
    for tip in tips(here.body):
        ends = told.positions[:, [kind == "leaf" for kind in told.kinds]]
        away = np.linalg.norm(ends - here.body.x[: len(ends), [tip]], axis=2).max(axis=0)
        assert away.min() < 1.0


def test_lengths_are_fixed_and_turning_is_that_of_the_arms() -> None:
    told = made().skeleton
    for j, p in enumerate(told.parents):
        if p >= 0:
            length = np.linalg.norm(told.positions[:, j] - told.positions[:, p], axis=1)
            assert length == pytest.approx(told.lengths[j])
    assert all(60 < d < 110 for d, kind in zip(told.degrees, told.kinds, strict=True) if kind == "joint")
    assert told.confidence.min() > 0.9


def test_still_body_has_no_joint() -> None:
    told = made(still=True).skeleton
    assert told.kinds == ("root", "leaf", "leaf", "leaf")
    assert "no joints" in views.remarks(told)[0]
