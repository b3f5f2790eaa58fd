"""Contract of cylinders: all of the surface is defined."""

import numpy as np
from mesoscopic import mesoscopic

from kinetree.tasks.paper_2014.cylinders import cylinders


def test_areas_are_on_the_interval_that_shows_most_and_cover_it() -> None:
    areas = mesoscopic().cylinders
    assert areas.interval == 0
    assert areas.cones == 3
    assert (areas.label >= 0).all()
    assert (np.bincount(areas.label, minlength=len(areas.rigid)) > 0).all()


def test_every_arm_ends_in_a_joint_and_the_middle_is_rigid() -> None:
    here = mesoscopic()
    areas = here.cylinders
    assert (~areas.rigid).sum() == 3
    middle = np.linalg.norm(here.body.V, axis=1) < 8.0
    assert areas.rigid[areas.label[middle]].all()
    assert (areas.cylinder[areas.label[middle]] >= areas.cones).all()


def test_body_without_cones_is_one_rigid_area() -> None:
    here = mesoscopic()
    bare = here.cone_consistency.model_copy(
        update={"annulus": here.cone_consistency.annulus[:0], "leaf": here.cone_consistency.leaf[:, :0]}
    )
    none = here.integration.model_copy(update={"rigid": here.integration.rigid[:0]})
    areas = cylinders(here.interval_references, here.alignments, bare, here.cut_correspondence, none)
    assert areas.rigid.tolist() == [True]
    assert (areas.annulus == -1).all()
