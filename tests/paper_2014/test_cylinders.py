"""Contract of cylinders: all of the surface is defined."""

import numpy as np
from mesoscopic import made

from kinetree.tasks.paper_2014.cylinders import cylinders


def test_areas_are_on_the_interval_that_shows_most_and_cover_it() -> None:
    told = made().cylinders
    assert told.interval == 0
    assert told.cones == 3
    assert (told.label >= 0).all()
    assert (np.bincount(told.label, minlength=len(told.rigid)) > 0).all()


def test_every_arm_ends_in_a_joint_and_the_middle_is_rigid() -> None:
    here = made()
    told = here.cylinders
    assert (~told.rigid).sum() == 3
    middle = np.linalg.norm(here.body.V, axis=1) < 8.0
    assert told.rigid[told.label[middle]].all()
    assert (told.piece[told.label[middle]] >= told.cones).all()


def test_body_without_cones_is_one_rigid_area() -> None:
    here = made()
    bare = here.consistency.model_copy(update={"ring": here.consistency.ring[:0], "leaf": here.consistency.leaf[:, :0]})
    none = here.integration.model_copy(update={"rigid": here.integration.rigid[:0]})
    told = cylinders(here.middle, here.alignment, bare, here.crossing, none)
    assert told.rigid.tolist() == [True]
    assert (told.annulus == -1).all()
