"""Laws of surfaces of volumes: closed whatever the volume, where the level is, whichever side is marked."""

import numpy as np
import pytest
import trimesh

from kinetree.errors import HullError
from kinetree.tasks.numerics.input.hull import Field
from kinetree.tasks.numerics.input.isosurface import isosurface, signed_distance
from kinetree.tasks.numerics.input.volumes import Grid

ORIGIN, STEP = np.array([5.0, -2.0, 1.0]), np.array([0.1, 0.1, 0.125])
POINTS = ORIGIN + np.stack(np.meshgrid(*(np.arange(n) for n in (30, 34, 28)), indexing="ij"), axis=-1) * STEP
CENTRE = POINTS.reshape(-1, 3).mean(axis=0)
AWAY = 1.2 - np.linalg.norm(POINTS - CENTRE, axis=-1)


def surface_of(values, **options):
    field, cut = signed_distance(Grid(values, ORIGIN, STEP), options.get("level"), options.get("smoothing", 1.0))
    V, F = isosurface(field)
    return trimesh.Trimesh(V, F, process=False), cut


def radii(mesh):
    return np.linalg.norm(mesh.vertices - CENTRE, axis=1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_signed_distance_gives_the_ball_whichever_side_is_negative(sign):
    mesh, cut = surface_of(sign * AWAY)
    assert mesh.is_watertight
    assert mesh.volume > 0
    assert cut == 0
    np.testing.assert_allclose(radii(mesh), 1.2, atol=0.01)


@pytest.mark.parametrize("values", [AWAY > 0, (AWAY > 0) * np.uint8(255), AWAY <= 0, np.where(AWAY > 0, 1.0, 0.0)])
def test_occupancy_gives_the_ball_within_a_third_of_a_voxel(values):
    mesh, _ = surface_of(values)
    assert mesh.is_watertight
    assert mesh.volume > 0
    assert np.abs(radii(mesh) - 1.2).max() < 0.05
    assert np.std(radii(mesh)) < 0.6 * np.std(radii(surface_of(values, smoothing=0.0)[0]))


def test_density_has_its_surface_halfway_or_at_the_level_that_is_given():
    density = 100.0 / (1.0 + np.exp(-AWAY / 0.15))
    np.testing.assert_allclose(radii(surface_of(density)[0]), 1.2, atol=0.03)
    np.testing.assert_allclose(radii(surface_of(density, level=80.0)[0]), 1.2 - 0.15 * np.log(4.0), atol=0.03)


def test_body_that_the_volume_cuts_is_closed_and_counted():
    mesh, cut = surface_of(np.where(POINTS[..., 0] < CENTRE[0], AWAY, AWAY)[12:])
    assert mesh.is_watertight
    assert cut > 10


def test_every_volume_gives_a_closed_manifold():
    rng = np.random.default_rng(3)
    for _ in range(20):
        values = rng.normal(size=(9, 8, 10)).astype(np.float32)
        _, F = isosurface(Field(values, np.zeros(3), np.ones(3)))
        ends = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
        counts = np.unique(ends, axis=0, return_counts=True)[1]
        assert set(counts) == {2}


@pytest.mark.parametrize(("values", "level"), [(np.zeros((4, 4, 4)), None), (AWAY, 7.0)])
def test_volume_on_one_side_of_the_level_is_refused(values, level):
    with pytest.raises(HullError, match=r"lie on one side of the level"):
        surface_of(values, level=level)


def test_field_without_a_point_inside_is_refused():
    with pytest.raises(HullError, match="no point inside the body"):
        isosurface(Field(np.full((4, 4, 4), -1.0, np.float32), np.zeros(3), np.ones(3)))
