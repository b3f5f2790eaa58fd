"""Contract of the transferred alignment: the skeleton's mesh in one frame, as every method leaves it."""

import numpy as np
from mesoscopic import mesoscopic

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.schemas.registration.alignment import Alignment
from kinetree.tasks.paper_2014.transferred_alignment import transferred_alignment


def aligned(t: int, *, tracked: bool, missing: slice = slice(0)) -> tuple[np.ndarray, Alignment]:
    here = mesoscopic()
    position = here.body.x[t].copy()
    position[missing] = np.nan
    none = np.zeros(0)
    mesh = Mesh(vertices=here.body.x[t], faces=here.body.F, vertex_of_input=np.arange(len(position)), cleaning=Cleaning())
    transfer = Transfer(model_vertex=none.astype(int), distance=none, model_position=position, tracked=tracked)
    return here.body.x[t], transferred_alignment((transfer,), mesh, here.skeleton)


def test_transferred_vertices_keep_their_positions_with_full_confidence() -> None:
    for tracked in (True, False):
        x, alignment = aligned(3, tracked=tracked)
        np.testing.assert_array_equal(alignment.vertices, x)
        np.testing.assert_allclose(alignment.residual, 0.0, atol=1e-9)
        assert np.median(alignment.confidence) == 1.0
        assert alignment.unreliable < 0.01, "only the flesh of joints stretches"


def test_vertex_without_a_position_moves_with_those_around_it_and_has_no_confidence() -> None:
    for tracked in (True, False):
        x, alignment = aligned(3, tracked=tracked, missing=slice(10, 14))
        assert np.isfinite(alignment.vertices).all()
        assert np.linalg.norm(alignment.vertices - x, axis=1).max() < 2.0
        assert (alignment.confidence[10:14] == 0.0).all()
        assert alignment.unreliable >= 4 / len(x)
    _, exact = aligned(3, tracked=True, missing=slice(10, 14))
    assert (np.delete(exact.confidence, range(10, 14)) == 1.0).all()
