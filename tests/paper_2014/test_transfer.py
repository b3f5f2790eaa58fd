"""Contract of landing: which vertex of the skeleton's mesh a frame's input vertices are."""

import numpy as np
from mesoscopic import made

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.tasks.paper_2014.transfer import transfer


def test_tracked_vertices_land_on_themselves_and_dropped_ones_nowhere() -> None:
    here = made()
    count = len(here.body.V)
    became = np.append(np.arange(count)[::-1], -1)
    for interval, t in ((0, 3), (1, 14)):
        mesh = Mesh(vertices=here.body.x[t], faces=here.body.F, vertex_of_input=became, cleaning=Cleaning())
        given = (here.middle[interval], here.alignment[t], here.consistency, here.crossing, here.cylinders, here.bones)
        told = transfer(mesh, *given)
        assert (told.corner == became).all()
        assert (told.distance[:-1] == 0.0).all()
        assert np.isnan(told.distance[-1])
        np.testing.assert_array_equal(told.place, here.body.x[t])
