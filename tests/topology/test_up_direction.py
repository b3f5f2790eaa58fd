"""Contract of upright: what the user says goes before what is found, and a guess is said to be one."""

import numpy as np
from results.rigged_bodies import spider
from results.sample_report import followed

from kinetree.pipeline import views
from kinetree.schemas.topology.up_direction import UpDirectionParams
from kinetree.tasks.topology.up_direction import up_direction


def test_what_the_user_says_is_so() -> None:
    estimate = up_direction(followed(spider()), UpDirectionParams(up="-z"))
    assert (estimate.up, estimate.axis, estimate.confidence, views.remarks(estimate)) == ("-z", ~2, 1.0, ())


def test_nothing_to_tell_by_is_said_to_be_a_guess() -> None:
    whole = followed(spider())
    estimate = up_direction(whole.model_copy(update={"positions": whole.positions[:0] * np.nan}), UpDirectionParams())
    assert (estimate.up, estimate.axis, estimate.confidence) == ("y", 1, 0.0)
    assert "up direction not certain" in views.remarks(estimate)[0]
    assert "--set up_direction.up=" in views.remarks(estimate)[0]
