"""Contract of graph_projection: labels come back to the input's vertices."""

import numpy as np
from volumetric import volumetric

from kinetree.tasks.paper_2009.graph_projection import graph_projection


def test_vertices_are_projected_to_the_arm_that_they_are_on() -> None:
    here = volumetric()
    frame = next(t for t in here.mesh if t != here.integrated_structure.frame)
    at = graph_projection(here.mesh[frame], here.integrated_structure, here.graph_alignment[frame])
    corner = here.body.F[at.face, at.share.argmax(axis=1)]
    assert (here.body.label[corner] == here.body.label).mean() > 0.97
    assert np.allclose(at.share.sum(axis=1), 1.0)


def test_dropped_vertices_are_on_no_face() -> None:
    here = volumetric()
    gone = here.mesh[0].vertex_of_input.copy()
    gone[5] = -1
    mesh = here.mesh[0].model_copy(update={"vertex_of_input": gone})
    at = graph_projection(mesh, here.integrated_structure, here.graph_alignment[0])
    assert at.face[5] == -1
    assert np.isnan(at.distance[5])
