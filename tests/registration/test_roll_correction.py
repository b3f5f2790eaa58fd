"""Contract of the untwisting: each frame takes its own row, only the limb that turned moves, other frames pass through."""

import numpy as np
from stepwise import lost, walk

from kinetree.tasks.registration.roll_correction import roll_correction
from kinetree.tasks.registration.roll_path import roll_path


def test_where_nothing_was_lost_the_pose_passes_through() -> None:
    made = walk()
    still = made.twist.model_copy(update={"turn": np.full_like(made.twist.turn, -1)})
    for t, refit in made.first_refit.items():
        found = roll_correction(made.template, refit, made.pieces, made.turns[t], still)
        assert np.array_equal(found.rotation, refit.rotation)
        assert np.array_equal(found.translation, refit.translation)
        assert found.steps == refit.steps


def test_only_the_limb_that_turned_moves_and_the_reference_stays() -> None:
    made = walk()
    told = lost(1)
    chosen = roll_path(told, made.template, made.pieces, made.reference)
    for t, refit in made.first_refit.items():
        found = roll_correction(made.template, refit, made.pieces, told[t], chosen)
        moved = (found.rotation != refit.rotation).any(axis=(1, 2))
        assert np.array_equal(moved, (chosen.limb == 1) & (t != made.reference.frame))
