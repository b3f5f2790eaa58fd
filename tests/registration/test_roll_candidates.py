"""Contract of roll candidates: every frame tries the same limbs, the reference fits as it is, one pass is searched."""

import numpy as np
import pytest
from stepwise import walk

from kinetree.tasks.registration.roll_candidates import roll_candidates


def test_every_frame_tries_the_same_limbs() -> None:
    made = walk()
    shapes = {t.misfit.shape for t in made.roll_candidates[1].values()}
    assert len(shapes) == 1
    assert shapes.pop()[0] > 2
    for told in made.roll_candidates[1].values():
        assert ((told.misfit >= 0) & (told.misfit <= 1)).all()


def test_in_the_reference_nothing_fits_better_than_no_roll() -> None:
    made = walk()
    told = made.roll_candidates[1][made.reference.frame]
    assert (told.misfit[:, 0] <= told.misfit.min(axis=1) + 0.02).all()
    assert np.abs(told.angle[:, 0]).max() < np.radians(5.0)


def test_passes_without_a_search_try_nothing() -> None:
    made = walk()
    for number in (0, 2):
        assert list(made.deformation_graph.members("pass/search", (number,))) == []
    assert list(made.deformation_graph.members("pass/search", (1,))) == [0]


def test_before_the_first_pass_there_are_no_poses_to_try_rolls_from() -> None:
    made = walk()
    with pytest.raises(ValueError, match="pass before"):
        roll_candidates(made.mesh[0], made.deformation_graph, made.stiffness[0], None)
