"""Laws of matches between a body and a frame, on tubes."""

import numpy as np
import pytest
from limbs import LENGTH, tube
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.registration.correspondence import (
    Target,
    covered_samples,
    local_matches,
    uncovered,
)


@pytest.fixture(scope="module")
def frame():
    return Target.of(*tube(), size=7.0, samples=400)


def test_a_walk_over_a_convex_body_ends_where_a_search_of_all_vertices_does(frame):
    x, _ = tube(around=19, along=37, start=0.1)
    n = smoothed_normals(*tube(around=19, along=37, start=0.1))
    tree = cKDTree(np.hstack([frame.V, frame.beta * frame.N]))
    near = frame.nearest(x, n)
    ended = local_matches(x, n, near, frame.V, frame.N, frame.start, frame.ring, frame.beta)
    distance, best = tree.query(np.hstack([x, frame.beta * n]))
    mine = np.linalg.norm(np.hstack([x - frame.V[ended], frame.beta * (n - frame.N[ended])]), axis=1)
    assert (ended == best).mean() > 0.95
    assert (mine <= distance * 1.5 + 1e-12).all()


def test_no_walk_ends_further_away_than_it_began(frame):
    rng = np.random.default_rng(0)
    match = rng.integers(len(frame.V), size=100)
    x, n = rng.normal(size=(100, 3)) * 3, rng.normal(size=(100, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)

    def distance(m):
        return ((x - frame.V[m]) ** 2).sum(1) + frame.beta**2 * ((n - frame.N[m]) ** 2).sum(1)

    ended = local_matches(x, n, match, frame.V, frame.N, frame.start, frame.ring, frame.beta)
    assert (distance(ended) <= distance(match) + 1e-12).all()


def test_the_direction_tells_the_two_sides_of_a_sheet_apart():
    V, F = tube(around=48, along=96, flat=0.05)
    thin = Target.of(V, F, size=7.0, samples=len(V))
    top = np.flatnonzero((np.abs(V[:, 2]) < 3) & (thin.N[:, 1] > 0.9))
    shifted = V[top] - [0.0, 0.1, 0.0]
    assert (thin.N[thin.nearest(shifted, thin.N[top]), 1] > 0).all()


def test_neighbours_are_mutual_and_six_on_a_regular_part():
    _, F = tube(around=10, along=8)
    start, ring = rings(F, F.max() + 1)
    pairs = {(v, int(u)) for v in range(len(start) - 1) for u in ring[start[v] : start[v + 1]]}
    assert pairs == {(u, v) for v, u in pairs}
    assert (np.diff(start)[20:50] == 6).all()


def test_a_body_covers_itself_and_a_missing_half_is_uncovered(frame):
    V, F = tube()
    N = smoothed_normals(V, F)
    assert uncovered(V, N, F, frame) == 0.0
    half = F[(V[F, 2] < 0).all(axis=1)]
    assert uncovered(V, N, half, frame) == pytest.approx(0.5, abs=0.03)
    seen = covered_samples(V, N, half, frame)
    assert (frame.V[frame.sample][seen, 2] < 0.3).all()


def test_a_longer_limb_than_the_frames_uncovers_nothing_but_a_shorter_one_does():
    V, F = tube()
    longer = V * [1, 1, 1.0] + np.where(V[:, 2:] > 0, 1.0, 0.0) * [0, 0, LENGTH / 5]
    frame = Target.of(longer, F, size=7.0, samples=400)
    assert uncovered(V, smoothed_normals(V, F), F, frame) > 0.05
    assert uncovered(longer, smoothed_normals(longer, F), F, Target.of(V, F, size=7.0, samples=400)) < 0.25


def test_a_surface_inside_out_covers_nothing(frame):
    V, F = tube()
    assert uncovered(V, -smoothed_normals(V, F), F, frame) == 1.0
