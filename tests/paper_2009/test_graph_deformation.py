"""Contract of graph_deformation: the model on the frame's surface, or at the nodes of its graph."""

import numpy as np
from volumetric import volumetric

from kinetree.tasks.numerics.geometry.inside import inside


def test_model_lies_on_the_surface_of_every_frame() -> None:
    here = volumetric()
    size = here.initial_model[0].size
    for moved in here.graph_deformation.values():
        assert np.median(moved.residual) < 0.002 * size


def test_nodes_of_every_frame_are_inside() -> None:
    here = volumetric()
    for t, moved in here.graph_deformation.items():
        assert inside(np.array(moved.position), np.array(here.mesh[t].vertices), here.mesh[t].faces).all()


def test_letter_leaves_the_model_farther_off_than_the_default() -> None:
    default, literal = (volumetric(letter=letter).graph_deformation.values() for letter in (False, True))
    assert np.mean([m.residual.mean() for m in literal]) > 3.0 * np.mean([m.residual.mean() for m in default])
