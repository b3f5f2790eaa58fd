"""Contract of the twist: what was lost in many frames is chosen, by frame, and nodes know the limb that turned."""

import numpy as np
from stepwise import lost, walk

from kinetree.tasks.registration.roll_path import roll_path


def test_every_frame_has_a_row_and_the_reference_stays() -> None:
    made = walk()
    assert made.twist.frames == tuple(made.mesh)
    assert made.twist.turn.shape == made.twist.misfit.shape[:2]
    assert (made.twist.turn[made.twist.frames.index(made.reference.frame)] == -1).all()


def test_a_limb_that_had_lost_its_twist_turns_and_no_other() -> None:
    made = walk()
    found = roll_path(lost(1), made.template, made.pieces, made.reference)
    assert (found.turn[:, 1] == np.where(np.array(found.frames) == made.reference.frame, -1, 3)).all()
    assert (np.delete(found.turn, 1, axis=1) == -1).all()
    assert set(found.limb.tolist()) == {-1, 1}
