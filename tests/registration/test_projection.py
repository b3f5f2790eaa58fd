"""Contract of projection: every vertex of the user's file has a point on the reference, or says that it has none."""

import numpy as np
import pytest
from stepwise import aligned, generated, walk

from kinetree.schemas.input.mesh import Mesh
from kinetree.tasks.registration.projection import projection


def landed(made, t):
    """(input vertex, xyz) where the projected points are in frame t."""
    point = made.projection[t]
    return np.einsum("vk,vkx->vx", point.share, made.alignment[t].vertices[made.reference.faces[point.face]])


def test_points_lie_on_the_aligned_mesh_at_the_distance_stored() -> None:
    made = walk()
    for t, mesh in made.mesh.items():
        point = made.projection[t]
        assert point.share.sum(axis=1) == pytest.approx(1.0)
        away = np.linalg.norm(landed(made, t) - mesh.vertices[mesh.vertex_of_input], axis=1)
        assert away == pytest.approx(point.distance, abs=1e-9 * made.reference.size)
        assert point.distance.mean() < 0.01 * made.reference.size


def test_in_the_reference_frame_every_vertex_lands_on_itself() -> None:
    made = walk()
    assert made.projection[made.reference.frame].distance.max() < 1e-9 * made.reference.size


def test_vertex_that_cleaning_dropped_has_no_place() -> None:
    made = walk()
    mesh: Mesh = made.mesh[1].model_copy(update={"vertex_of_input": np.array([5, -1, 5, 0])})
    point = projection(mesh, made.reference, made.alignment[1])
    assert point.face[1] == -1
    assert point.share[1].tolist() == [0, 0, 0]
    assert np.isnan(point.distance[1])
    assert point.face[0] == point.face[2] == made.projection[1].face[np.flatnonzero(made.mesh[1].vertex_of_input == 5)[0]]


def test_with_fixed_connectivity_every_vertex_lands_on_itself() -> None:
    made = aligned(generated(connectivity="fixed", frames=3))
    assert made.reference.fixed
    rounding = 1e-12 * made.reference.size
    for t in made.mesh:
        np.testing.assert_allclose(landed(made, t), made.mesh[t].vertices, atol=rounding)
        assert made.projection[t].distance.max() < rounding
        corner = made.reference.faces[made.projection[t].face, made.projection[t].share.argmax(axis=1)]
        assert np.array_equal(corner, made.mesh[t].vertex_of_input)
