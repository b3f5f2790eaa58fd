"""Contract of graph_reference: the initial frame of the structure."""

import numpy as np
from volumetric import volumetric


def test_reference_is_the_mesh_of_the_initial_frame() -> None:
    here = volumetric()
    one, reference = here.integrated_structure, here.graph_reference
    assert reference.frame == one.frame
    assert np.array_equal(reference.vertices, one.vertices)
    assert reference.free
    assert not reference.fixed
