"""Contract of transfer: which vertex of the model mesh a frame's input vertices are, and the reverse."""

import numpy as np
from mesoscopic import mesoscopic

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.tasks.paper_2014.transfer import transfer


def test_vertices_correspond_to_themselves_and_dropped_ones_to_none() -> None:
    here = mesoscopic()
    count = len(here.body.V)
    cleaned = np.append(np.arange(count)[::-1], -1)
    for interval, t in ((0, 3), (1, 14)):
        mesh = Mesh(vertices=here.body.x[t], faces=here.body.F, vertex_of_input=cleaned, cleaning=Cleaning())
        given = (here.interval_references[interval], here.alignments[t], here.cut_correspondence, here.cylinders, here.bones)
        artifact = transfer((interval, t), mesh, *given)
        assert (artifact.model_vertex == cleaned).all()
        assert (artifact.distance[:-1] == 0.0).all()
        assert np.isnan(artifact.distance[-1])
        np.testing.assert_array_equal(artifact.model_position, here.body.x[t])
        assert artifact.tracked
