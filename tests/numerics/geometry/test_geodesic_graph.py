"""Laws of the graph of straight lines over a surface."""

import numpy as np
import numpy.typing as npt
import pytest
import shapes
from exact_distances import exact_distances

from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.geodesic_graph import ANYWHERE, BITS, SECTORS
from kinetree.tasks.numerics.geometry.surface import Surface

Ints = npt.NDArray[np.int64]


def ends(surface: Surface) -> tuple[Ints, Ints]:
    """(link,) vertices at both ends in the input's numbering."""
    links = surface.links
    here = np.repeat(np.arange(len(surface.order)), np.diff(links.first.astype(np.int64)))
    return surface.order[here], surface.order[(links.link["target"] >> BITS).astype(np.int64)]


def rough() -> tuple[npt.NDArray[np.float64], Ints]:
    V, F, _ = shapes.y_pipe()
    return V + np.random.default_rng(3).normal(scale=0.08, size=V.shape), F


def test_on_a_rough_body_no_link_is_shorter_than_the_exact_distance() -> None:
    V, F = rough()
    surface = Surface.of(V, F)
    here, there = ends(surface)
    exact = exact_distances(V, F, np.arange(0, len(V), 50))
    for row, source in zip(exact, range(0, len(V), 50), strict=True):
        own = here == source
        assert own.sum() > 15
        assert np.all(surface.links.link["length"][own] >= row[there[own]] * (1 - 1e-5))


def test_in_the_plane_links_are_as_long_as_straight_lines() -> None:
    V, F = shapes.flat_grid(20, 20, 0.7)
    surface = Surface.of(V, F)
    here, there = ends(surface)
    assert np.allclose(surface.links.link["length"], np.linalg.norm(V[here] - V[there], axis=1), rtol=1e-5)


def test_no_link_passes_over_a_vertex() -> None:
    V, F = shapes.flat_grid(20, 20)
    here, there = ends(Surface.of(V, F))
    step = (V[there] - V[here])[:, :2].astype(int)
    assert np.all(np.gcd(step[:, 0], step[:, 1]) == 1)


def test_no_vertex_is_linked_to_itself_or_twice_to_another() -> None:
    here, there = ends(Surface.of(*rough()))
    assert np.all(here != there)
    assert len(np.unique(here * 10**6 + there)) == len(here)


def test_links_seen_from_one_end_are_there_from_the_other_unless_others_serve() -> None:
    V, F = rough()
    here, there = ends(Surface.of(V, F))
    forth, back = set(zip(here, there, strict=True)), set(zip(there, here, strict=True))
    assert len(forth & back) > 0.95 * len(forth)


def test_what_is_followed_after_a_link_in_the_plane_goes_straight_on() -> None:
    V, F = shapes.flat_grid(25, 25)
    surface = Surface.of(V, F)
    links = surface.links
    here, there = ends(surface)
    V, middle = V[:, :2], 312
    inner = there == middle
    rank = int(np.flatnonzero(surface.order == middle)[0])
    own = np.arange(links.first[rank], links.first[rank + 1])
    for k in np.flatnonzero(inner):
        onward = int(links.onward[rank, links.link["target"][k] & SECTORS])
        begin, count = onward >> 8, onward & 255
        followed = own[(begin + np.arange(count)) % len(own)]
        along, to = V[middle] - V[here[k]], V[there[followed]] - V[middle]
        cosine = to @ along / np.linalg.norm(to, axis=1) / np.linalg.norm(along)
        assert cosine.min() > np.cos(np.deg2rad(30 + 360 / SECTORS))
        assert cosine.max() > np.cos(np.deg2rad(10))
        assert count < len(own) / 2


def test_from_anywhere_and_at_borders_all_links_are_followed() -> None:
    surface = Surface.of(*shapes.flat_grid(9, 9))
    border = surface.position[surface.order][:, 0] == 0
    assert np.all(surface.links.onward[:, ANYWHERE] == 0)
    assert np.all(surface.links.onward[border] == 0)


@pytest.mark.parametrize("around", [200, 700])
def test_a_vertex_with_hundreds_of_edges_keeps_them_all(around: int) -> None:
    theta = 2 * np.pi * np.arange(around) / around
    rim = np.stack([np.cos(theta), np.sin(theta), np.zeros(around)], axis=1)
    V = np.concatenate([rim, 1.2 * rim, [[0.0, 0.0, 1.0]]])
    i = np.arange(around)
    j = (i + 1) % around
    faces = (i, j, np.full(around, 2 * around)), (i, i + around, j + around), (i, j + around, j)
    F = np.concatenate([np.stack(face, axis=1) for face in faces])
    distance = geodesic_distance(Surface.of(V, F), [2 * around])[0]
    assert np.allclose(distance[:around], np.sqrt(2), rtol=1e-4)
