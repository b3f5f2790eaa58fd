"""Laws of what is the same surface: in any order of vertices and faces, and as far as formats keep coordinates."""

import numpy as np
import pytest
from shapes import sphere

from kinetree.tasks.numerics.input.bad_frames import frame_measures
from kinetree.tasks.numerics.input.same_surfaces import (
    SameSurfaceSettings,
    have_same_frames,
    have_same_measures,
    surface_distance,
)

V, F = sphere(3)
V = V * (1.0, 2.0, 3.0)
SIZE = float(np.linalg.norm(np.ptp(V, axis=0)))
REACH = SameSurfaceSettings().distance * SIZE
MOVED = V * (1.0, 1.0, 1.05)
"""Another frame of a take that moves."""


def frames_are_same(takes):
    """Whether two takes, each a list of meshes, have the same frames, whichever comes first."""

    def ask(some, others):
        measures = [[frame_measures(*mesh) for mesh in take] for take in (some, others)]
        apart = have_same_frames(
            len(some), lambda t, u: surface_distance(*some[t], *others[u]), lambda t, u: surface_distance(*some[t], *some[u])
        )
        return have_same_measures(*measures) and apart

    first, second = takes
    assert ask(first, second) is ask(second, first)
    return ask(first, second)


def are_same(W, G):
    """Whether a surface is V, F, in takes that move."""
    return frames_are_same([[(V, F), (MOVED, F)], [(W, G), (MOVED, F)]])


def test_order_of_vertices_and_faces_does_not_matter_nor_do_vertices_without_a_face():
    rng = np.random.default_rng(0)
    order = rng.permutation(len(V))
    W = np.concatenate([V[order], [[9.0, 9.0, 9.0]]])
    assert are_same(W, np.argsort(order)[F][rng.permutation(len(F))])


def test_three_vertices_of_its_own_for_every_face_are_the_same_surface():
    assert are_same(V[F].reshape(-1, 3), np.arange(3 * len(F)).reshape(-1, 3))


def test_coordinates_may_be_rounded_and_no_more():
    rng = np.random.default_rng(0)
    away = rng.normal(size=V.shape)
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    assert are_same(V + 0.5 * REACH * away, F)
    assert are_same(V + 2.0 * REACH * away, F) is False


def test_one_vertex_elsewhere_is_another_surface():
    W = V.copy()
    W[0] += 2.0 * REACH
    assert not are_same(W, F)
    assert not are_same(V[F[1:]].reshape(-1, 3)[: 3 * len(F) // 2], np.arange(3 * (len(F) // 2)).reshape(-1, 3))


@pytest.mark.parametrize("count", [0, 2])
def test_takes_without_measures_or_of_other_lengths_are_never_the_same(count):
    own = frame_measures(V, F)
    assert not have_same_measures([own] * count, [own] * (1 if count else 0))


def still(seed, noise, count=12):
    """A take of a body that stands still, but for noise of this share of its size."""
    rng = np.random.default_rng(seed)
    return [(V + rng.normal(scale=noise * SIZE, size=V.shape), F) for _ in range(count)]


def rounded(take, step):
    """The take in a format that keeps coordinates to this share of the size."""
    return [(np.round(W / (step * SIZE)) * step * SIZE, G) for W, G in take]


@pytest.mark.parametrize("noise", [2e-5, 5e-5, 1.5e-4])
def test_two_takes_of_a_body_that_stands_still_are_two(noise):
    assert surface_distance(*still(0, noise)[0], *still(1, noise)[0]) < SameSurfaceSettings().distance
    assert not frames_are_same([still(0, noise), still(1, noise)])


@pytest.mark.parametrize(("noise", "step"), [(2e-4, 1e-4), (2e-4, 1e-7), (0.0, 1e-6)])
def test_a_copy_of_a_take_of_a_body_that_stands_still_is_one(noise, step):
    take = still(0, noise)
    assert frames_are_same([take, rounded(take, step)])


def test_two_takes_of_a_body_that_sways_slowly_are_two():
    """Neighbouring frames are much nearer to each other than the takes are."""
    sway = np.sin(np.linspace(0.0, 2.0, 40)) * 4e-4 * SIZE
    takes = [[(V + (x + shift, 0.0, 0.0), F) for x in sway] for shift in (0.0, 4e-4 * SIZE)]
    assert not frames_are_same(takes)


def test_a_single_frame_is_a_copy_only_where_nothing_but_rounding_differs():
    take = still(0, 2e-4, 1)
    assert frames_are_same([take, rounded(take, 1e-6)])
    assert not frames_are_same([take, still(1, 2e-4, 1)])
