"""μ of one frame, as the task gives it."""

import numpy as np
import pytest
import trimesh

from kinetree.errors import MeshError
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.topology.geodesics import GeodesicsParams
from kinetree.tasks.topology.geodesics import geodesics


def mesh(*parts: trimesh.Trimesh) -> Mesh:
    whole = trimesh.util.concatenate(parts)
    V = np.array(whole.vertices)
    return Mesh(vertices=V, faces=np.array(whole.faces), vertex_of_input=np.arange(len(V)), cleaning=Cleaning())


BALL = trimesh.creation.icosphere(subdivisions=4)
SMALL = trimesh.creation.icosphere(subdivisions=2, radius=0.3).apply_translation([3, 0, 0])


def test_mu_of_the_sphere_is_everywhere_two_pi_squared() -> None:
    measured = geodesics(mesh(BALL), GeodesicsParams())
    assert measured.mu == pytest.approx(np.full(len(BALL.vertices), 2 * np.pi**2), rel=0.01)
    assert measured.area.sum() == pytest.approx(BALL.area)
    assert measured.share == 1


def test_literal_sum_counts_every_vertex_once() -> None:
    literal = geodesics(mesh(BALL), GeodesicsParams(sum="vertices"))
    assert len(literal.bases) == 0
    assert literal.mu.mean() == pytest.approx(len(BALL.vertices) * np.pi / 2, rel=0.01)


def test_what_floats_beside_the_body_has_no_mu_and_no_area() -> None:
    measured = geodesics(mesh(BALL, SMALL), GeodesicsParams())
    aside = np.arange(len(BALL.vertices), len(BALL.vertices) + len(SMALL.vertices))
    assert np.isnan(measured.mu[aside]).all()
    assert not np.isnan(measured.mu[: aside[0]]).any()
    assert measured.area[aside].sum() == 0
    assert measured.share == pytest.approx(1 / 1.09, rel=0.01)
    assert measured.bases.max() < aside[0]


def test_body_in_equal_pieces_is_refused_with_the_share_that_was_found() -> None:
    twin = BALL.copy().apply_translation([3, 0, 0])
    with pytest.raises(MeshError, match="50% of the surface's area, 60% are needed"):
        geodesics(mesh(BALL, twin), GeodesicsParams(least_share=0.6))
