"""Contract of projection: every vertex of the user's file has a point on the reference, or says that it has none."""

import numpy as np
import pytest
from stepwise import aligned, generated, walk

from kinetree.schemas.input.mesh import Mesh
from kinetree.tasks.registration.projection import projection


def landed(made, t):
    """(input vertex, xyz) where the projected points are in frame t."""
    told = made.projection[t]
    return np.einsum("vk,vkx->vx", told.share, made.alignment[t].vertices[made.reference.faces[told.face]])


def test_points_lie_on_the_aligned_mesh_at_the_distance_told() -> None:
    made = walk()
    for t, mesh in made.mesh.items():
        told = made.projection[t]
        assert told.share.sum(axis=1) == pytest.approx(1.0)
        away = np.linalg.norm(landed(made, t) - mesh.vertices[mesh.vertex_of_input], axis=1)
        assert away == pytest.approx(told.distance, abs=1e-9 * made.reference.size)
        assert told.distance.mean() < 0.01 * made.reference.size


def test_in_the_reference_frame_every_vertex_lands_on_itself() -> None:
    made = walk()
    assert made.projection[made.reference.frame].distance.max() < 1e-9 * made.reference.size


def test_vertex_that_cleaning_dropped_has_no_place() -> None:
    made = walk()
    mesh: Mesh = made.mesh[1].model_copy(update={"vertex_of_input": np.array([5, -1, 5, 0])})
    told = projection(mesh, made.reference, made.alignment[1])
    assert told.face[1] == -1
    assert told.share[1].tolist() == [0, 0, 0]
    assert np.isnan(told.distance[1])
    assert told.face[0] == told.face[2] == made.projection[1].face[np.flatnonzero(made.mesh[1].vertex_of_input == 5)[0]]


def test_with_fixed_connectivity_every_vertex_is_the_corner_that_it_is() -> None:
    made = aligned(generated(connectivity="fixed", frames=3))
    assert made.reference.fixed
    for t in made.mesh:
        assert np.array_equal(landed(made, t), made.mesh[t].vertices)
        assert not made.projection[t].distance.any()
        corner = made.reference.faces[made.projection[t].face, made.projection[t].share.argmax(axis=1)]
        assert np.array_equal(corner, made.mesh[t].vertex_of_input)
