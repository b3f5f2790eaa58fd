"""Contract of the landed alignment: the skeleton's mesh in one frame, as every method leaves it."""

import numpy as np
from mesoscopic import made

from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.tasks.paper_2014.transferred_alignment import transferred_alignment


def landed(t: int, fixed: bool, lost: slice = slice(0)):
    here = made()
    place = here.body.x[t].copy()
    place[lost] = np.nan
    none = np.zeros(0)
    mesh = Mesh(vertices=here.body.x[t], faces=here.body.F, vertex_of_input=np.arange(len(place)), cleaning=Cleaning())
    way = Transfer(corner=none.astype(int), distance=none, place=place)
    known = Connectivity(fixed=fixed, first_change=None, vertices=1, faces=1)
    return here.body.x[t], transferred_alignment((way,), mesh, here.skeleton, known)


def test_what_has_a_way_is_where_it_leads_and_trusted() -> None:
    for fixed in (True, False):
        x, told = landed(3, fixed)
        np.testing.assert_array_equal(told.vertices, x)
        np.testing.assert_allclose(told.residual, 0.0, atol=1e-9)
        assert np.median(told.trust) == 1.0
        assert told.doubted < 0.01, "only the flesh of joints stretches"


def test_what_has_none_goes_with_what_lies_around_it_and_is_not_trusted() -> None:
    x, told = landed(3, True, slice(10, 14))
    assert np.isfinite(told.vertices).all()
    assert np.linalg.norm(told.vertices - x, axis=1).max() < 2.0
    assert (told.trust[10:14] == 0.0).all()
    assert (np.delete(told.trust, range(10, 14)) == 1.0).all()
