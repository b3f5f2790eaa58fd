"""Laws of the similarity of two Reeb graphs."""

import numpy as np
import trimesh

from kinetree.tasks.numerics.paper_2009.reeb_graph import reeb_graph
from kinetree.tasks.numerics.paper_2009.similarity import Attributes, attributes, similarities


def of(mesh: trimesh.Trimesh) -> Attributes:
    V = np.array(mesh.vertices)
    return attributes(reeb_graph(V, np.array(mesh.faces), V[:, 0].copy(), 5))


def test_equal_graphs_have_similarity_one_whatever_the_scale_and_the_tessellation() -> None:
    ring = trimesh.creation.torus(3.0, 1.0)
    larger = ring.subdivide()
    larger.apply_scale(7.0)
    assert np.allclose(similarities([of(ring), of(larger)]), 1.0)


def test_sphere_is_less_similar_to_a_torus_than_another_torus_is() -> None:
    ball, ring, thin = trimesh.creation.icosphere(4), trimesh.creation.torus(3.0, 1.0), trimesh.creation.torus(3.0, 0.9)
    S = similarities([of(ring), of(thin), of(ball)])
    assert S[0, 1] > S[0, 2] + 0.03
