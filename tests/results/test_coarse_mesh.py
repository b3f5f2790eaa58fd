"""Coarse meshes keep vertices of the mesh, know their part, and are shared where faces are."""

import numpy as np
from results.rigged_bodies import spider
from results.sample_report import artifacts

from kinetree.schemas.results.coarse_mesh import CoarseMesh, CoarseMeshParams
from kinetree.tasks.results.coarse_mesh import coarse_mesh
from kinetree.tasks.results.page.coarse import alike, coarse_meshes

COUNT = 100
CONTENT = artifacts()


def of(frame: int, previous: CoarseMesh | None = None) -> CoarseMesh:
    mesh, projection = CONTENT["mesh"][frame], CONTENT["projection"][frame]
    return coarse_mesh(mesh=mesh, projection=projection, previous=previous, params=CoarseMeshParams(vertices=COUNT))


def test_vertices_are_some_of_the_mesh() -> None:
    coarse, mesh = of(0), CONTENT["mesh"][0]
    np.testing.assert_array_equal(coarse.vertices, mesh.vertices[coarse.kept])
    assert len(coarse.kept) <= 1.3 * COUNT < coarse.size == len(mesh.vertices)
    assert coarse.faces.max() == len(coarse.kept) - 1


def test_every_vertex_knows_the_point_of_the_reference_that_it_is() -> None:
    coarse, body = of(0), spider()
    order = np.random.default_rng(0).permutation(len(body.vertices))
    np.testing.assert_array_equal(body.faces[coarse.reference_face, coarse.reference_corner], order[coarse.kept])


def test_frame_with_the_same_faces_has_the_same_vertices_and_holds_no_faces() -> None:
    first = of(0)
    later = of(4, first)
    np.testing.assert_array_equal(later.vertices, CONTENT["mesh"][4].vertices[first.kept])
    assert (len(later.kept), len(later.faces)) == (0, 0)


def test_many_at_once_are_those_made_one_by_one() -> None:
    meshes = {frame: CONTENT["mesh"][frame] for frame in (0, 4)}
    coarse_of = coarse_meshes(meshes, CONTENT["projection"], COUNT)
    assert coarse_of[0] == of(0)
    assert coarse_of[4] == of(4, of(0))


def test_equal_faces_count_only_without_others_between() -> None:
    one, two = np.zeros((1, 3), np.int32), np.ones((1, 3), np.int32)
    assert alike({3: one, 5: one, 6: two, 9: one}) == (3, 3, 6, 9)
