"""Laws of bands, annuli and cones."""

import numpy as np
import pytest
from limbs import LENGTH, tube
from shapes import open_cylinder, y_pipe

from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.paper_2014.cones import (
    ConesSettings,
    bands,
    components,
    cones,
    dead_ends,
    edges,
    grown,
    neighbours,
)

PIPE, PIPE_FACES, _ = y_pipe()
TIP = int(PIPE[:, 0].argmax())
ALONG = geodesic_distance(Surface.of(PIPE, PIPE_FACES), np.array([TIP]))[0]


def cone(distance, V, F, seed, annuli=25):
    return grown(bands(distance, annuli), np.arange(len(V)) == seed, np.ones(len(V)), edges(F))


def test_bands_are_equally_wide_and_reach_to_the_farthest_vertex():
    band = bands(np.array([0.0, 0.99, 1.0, 24.9, 25.0, np.nan]), 25)
    assert band.tolist() == [0, 0, 1, 24, 24, -1]
    assert (bands(np.full(3, np.nan), 25) == -1).all()


def test_annuli_of_a_cylinder_are_rings_of_equal_width():
    V, F = open_cylinder(24, 51, height=10.0)
    annulus = cone(V[:, 2] + 1e-9, V, F, 0, annuli=10)
    assert annulus.max() == 9
    for k in range(10):
        assert np.ptp(V[annulus == k, 2]) == pytest.approx(0.8 if k < 9 else 1.0)


def test_cone_of_a_tube_is_all_of_it():
    V, F = tube()
    assert (cone(V[:, 2] + LENGTH / 2, V, F, len(V) - 2) >= 0).all()


def test_cone_of_an_arm_stops_where_the_pipe_branches():
    annulus = cone(ALONG, PIPE, PIPE_FACES, TIP)
    inside = annulus >= 0
    assert (inside == ((annulus.max() + 1) * ALONG.max() / 25 > ALONG)).all()
    other = np.array([[np.cos(a), np.sin(a), 0.0] for a in (2 * np.pi / 3, 4 * np.pi / 3)])
    assert (PIPE[inside] @ other.T).max() < 8.0, "no other arm is in it"
    assert PIPE[inside, 0].min() < 4.0, "it reaches the middle"


def test_every_annulus_is_connected():
    annulus = cone(ALONG, PIPE, PIPE_FACES, TIP)
    for k in range(annulus.max() + 1):
        assert (
            components(annulus == k, edges(PIPE_FACES)).max() == components(annulus == k, edges(PIPE_FACES))[annulus == k].min()
        )


def test_band_of_two_components_ends_the_cone():
    a, b = np.meshgrid(np.arange(12), np.arange(7), indexing="ij")
    hole = (abs(a - 6) < 3) & (abs(b - 3) < 2)
    number = np.where(hole.ravel(), -1, np.cumsum(~hole.ravel()) - 1).reshape(a.shape)
    pairs = [
        np.stack([number[:-1].ravel(), number[1:].ravel()], 1),
        np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], 1),
    ]
    E = np.concatenate(pairs)
    column = a[~hole]
    annulus = grown(column, column == 0, np.ones(len(column)), E[(E >= 0).all(axis=1)])
    assert annulus.max() == 3, "columns 4 to 8 have two components"


def test_ends_of_edges_are_neighbours():
    assert neighbours(np.array([True, False, False]), np.array([[0, 1], [1, 2]])).tolist() == [True, True, False]


def test_without_bands_there_is_no_cone():
    assert (grown(np.full(5, -1), np.ones(5, bool), np.ones(5), np.zeros((0, 2), np.int64)) == -1).all()


def test_fragment_of_a_band_is_ignored_unless_it_is_large():
    E = np.array([[0, 1], [0, 2]])  # a leaf, and a band of two components
    for share, end in ((0.05, 1), (0.5, 0)):
        annulus = grown(np.array([0, 1, 1]), np.array([True, False, False]), np.array([1.0, 1.0, share]), E)
        assert annulus.max() == end
    large = ConesSettings(least_component=0.6)
    assert grown(np.array([0, 1, 1]), np.array([True, False, False]), np.array([1.0, 1.0, 0.5]), E, large).max() == 1


def test_tip_that_ends_in_the_next_band_belongs_to_the_cone_and_a_limb_ends_it():
    band, leaf = np.array([0, 1, 1, 2, 2]), np.arange(5) == 0
    tip = np.array([[0, 1], [0, 2], [2, 3], [3, 4]])  # vertex 1 leads no farther
    limb = np.array([[0, 1], [0, 2], [2, 3], [1, 4]])
    assert dead_ends(band, tip).tolist() == [False, True, False, True, True]
    assert grown(band, leaf, np.ones(5), tip).tolist() == [0, 1, 1, 2, 2]
    assert grown(band, leaf, np.ones(5), limb).tolist() == [0, -1, -1, -1, -1]


def test_leaf_that_is_not_seen_has_no_cone_and_others_have_the_range_of_mu():
    mu = np.arange(len(PIPE), dtype=float)
    both = cones(np.stack([ALONG, ALONG]), np.array([-1, TIP]), mu, np.ones(len(PIPE)), PIPE_FACES, 25)
    assert (both.annulus[0] == -1).all()
    assert both.mu_range.tolist() == [0.0, np.ptp(mu[both.annulus[1] >= 0])]
