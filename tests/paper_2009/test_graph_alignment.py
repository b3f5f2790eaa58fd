"""Contract of graph_alignment: the surface of the structure with its own measures."""

import numpy as np
from volumetric import volumetric


def test_alignment_has_the_surface_of_the_motion() -> None:
    here = volumetric()
    for t, aligned in here.graph_alignment.items():
        assert np.array_equal(aligned.vertices, here.graph_motion[t].vertices)
        assert aligned.distance == float(np.median(aligned.residual))
