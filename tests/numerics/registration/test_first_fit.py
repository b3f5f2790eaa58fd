"""Laws of the first fit from a near pose: the end of a whole fit, and other ways where a limb is lost."""

from dataclasses import replace

import numpy as np
import pytest
from limbs import ANGLES, LENGTH, bent
from shipped import FITTING

from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, shape
from kinetree.tasks.numerics.registration.first_fit import first_fit, last_steps
from kinetree.tasks.numerics.registration.tracking import tracking


def test_a_near_pose_is_brought_onto_the_frame(body, targets):
    near = tracking(body, None, at_rest(body), targets[0], FITTING).pose
    found = first_fit(body, near, targets[1], FITTING)
    assert found.attempt == 0
    assert np.linalg.norm(shape(body, found.pose)[0] - bent(body.V, ANGLES[1]), axis=1).mean() < 0.01 * LENGTH


def test_a_far_pose_is_fitted_in_other_ways(body, targets):
    away = Pose(at_rest(body).rotation, at_rest(body).translation + [0.0, 0.0, 0.13 * body.size])
    found = first_fit(body, away, targets[0], FITTING)
    assert found.attempt > 0
    assert found.uncovered < 0.01
    assert first_fit(body, away, targets[0], FITTING, usual=1.0).attempt == 0


def test_last_steps_end_as_the_whole_fit_and_begin_where_it_is_by_then():
    late = last_steps(FITTING)
    assert late.steps == 6
    assert late.searches == 1
    for name in ("stiffness", "reach", "scale", "point_weight"):
        (first, last), (begin, end) = getattr(FITTING, name), getattr(late, name)
        assert end == last
        assert begin == pytest.approx(first * (last / first) ** (4 / 9))


def test_a_fit_of_one_step_keeps_it():
    assert last_steps(replace(FITTING, steps=1)).steps == 1
