"""Contract of the turns: every frame tries the same limbs, the reference fits as it is, and fixed connectivity has none."""

import numpy as np
from stepwise import walk

from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.roll_candidates import roll_candidates


def test_every_frame_tries_the_same_limbs() -> None:
    made = walk()
    shapes = {t.misfit.shape for t in made.turns.values()}
    assert len(shapes) == 1
    assert shapes.pop()[0] > 2
    for told in made.turns.values():
        assert ((told.misfit >= 0) & (told.misfit <= 1)).all()


def test_in_the_reference_nothing_fits_better_than_no_turn() -> None:
    made = walk()
    told = made.turns[made.reference.frame]
    assert (told.misfit[:, 0] <= told.misfit.min(axis=1) + 0.02).all()
    assert np.abs(told.angle[:, 0]).max() < np.radians(5.0)


def test_fixed_connectivity_tries_nothing() -> None:
    made = walk()
    empty = deformation_graph(made.reference.model_copy(update={"fixed": True}), DeformationGraphParams())
    assert len(roll_candidates(made.mesh[0], empty, made.first_refit[0], made.pieces).angle) == 0
