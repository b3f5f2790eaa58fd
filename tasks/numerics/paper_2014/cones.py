"""Annuli around a leaf, and the cone that they form (2014, Sec. 6.1.1.1; Figs. 4 and 7)."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints


class ConesSettings(NamedTuple):
    """When a band counts as disjoint."""

    least_component: float = 0.1
    """Smallest component of a band that makes it disjoint, share of the area of the band's largest component; chosen so that
    fragments that triangles cut off a band are ignored. Sensitivity not recorded. At 0 every fragment ends the cone, at 1
    nothing does."""


class Cones(NamedTuple):
    """The cones of one interval.

    annulus  : (leaf, vertex) annulus of every vertex, 0 around the leaf; −1 beyond the cone, and for a leaf not seen
    mu_range : (leaf,) range of μ in the cone, unit of μ
    """

    annulus: Ints
    mu_range: Floats


def cones(
    distance: Floats, leaf_vertex: Ints, mu: Floats, area: Floats, F: Ints, annuli: int, settings: ConesSettings | None = None
) -> Cones:
    """The cone of every leaf: its annuli up to the one before the band that is disjoint (Sec. 6.1.1.1).

    distance    : (leaf, vertex) geodesic distance from each leaf, mesh unit; NaN where there is none
    leaf_vertex : (leaf,) vertex of each leaf, −1 for a leaf that is not seen
    mu          : (vertex,) μ; NaN where there is none
    area, F     : (vertex,) mesh unit² · (face, corner)
    annuli      : bands in the longest distance from a leaf; the paper has 25 (footnote 1)
    """
    E = edges(F)
    annulus, mu_range = np.full(distance.shape, -1), np.zeros(len(distance))
    for n, vertex in enumerate(leaf_vertex):
        if vertex < 0:
            continue
        annulus[n] = grown(bands(distance[n], annuli), np.arange(len(mu)) == vertex, area, E, settings)
        inside = (annulus[n] >= 0) & np.isfinite(mu)
        mu_range[n] = np.ptp(mu[inside]) if inside.any() else 0.0
    return Cones(annulus, mu_range)


def edges(F: Ints) -> Ints:
    """(edge, 2) every edge of the faces once, the smaller vertex first.

    F : (face, corner)
    """
    pairs = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(pairs, axis=0).astype(np.int64)


def bands(distance: Floats, annuli: int) -> Ints:
    """B^k of one leaf: the k with distance in [δk, δ(k + 1)), δ the greatest distance over the number of annuli (Sec. 6.1.1.1).

    distance : (vertex,) from the leaf, mesh unit; NaN where there is none
    annuli   : bands in the greatest distance
    returns  : (vertex,) 0 around the leaf, −1 where there is no distance
    """
    known = np.isfinite(distance)
    band = np.full(len(distance), -1)
    greatest = float(distance[known].max(initial=0.0))
    if greatest > 0.0:
        band[known] = np.minimum((distance[known] * (annuli / greatest)).astype(np.int64), annuli - 1)
    return band


def grown(
    band: Ints, seed: Flags, area: Floats, E: Ints, settings: ConesSettings | None = None, *, dead_end: Flags | None = None
) -> Ints:
    """Adds the next adjacent band until that is disjoint (Sec. 6.1.1.1, steps 3 and 4).

    A disjoint band "partially covers at least two body extremities"; a dead end is none (ours): a bone takes two annuli
    (Sec. 6.1.2.3). It belongs to the annulus and does not end the cone.

    band     : (vertex,) see `bands`; vertices with −1 are never added
    seed     : (vertex,) where to begin: the components of the lowest band among them
    area     : (vertex,) mesh unit²
    E        : (edge, 2) vertices
    dead_end : (vertex,) see `dead_ends`; of these bands if not given
    returns  : (vertex,) annulus of every vertex, −1 beyond the cone
    """
    settings = settings or ConesSettings()
    dead_end = dead_ends(band, E) if dead_end is None else dead_end
    annulus = np.full(len(band), -1)
    seed = seed & (band >= 0)
    if not seed.any():
        return annulus
    k = int(band[seed].min())
    component = components(band == k, E)
    added = np.isin(component, component[seed & (band == k)])
    while True:
        annulus[added] = k
        component = components(band == k + 1, E)
        adjacent = np.unique(component[neighbours(added, E) & (band == k + 1)])
        through = np.unique(component[np.isin(component, adjacent) & ~dead_end & (component >= 0)])
        if len(_large(through if len(through) else adjacent, component, area, settings.least_component)) != 1:
            return annulus
        added, k = np.isin(component, adjacent), k + 1


def dead_ends(band: Ints, E: Ints) -> Flags:
    """(vertex,) whether the connected component of its band touches no farther band: the tip of a thumb, a chin, an ear.

    band, E : (vertex,) see `bands` · (edge, 2) vertices
    """
    inner_edges = E[band[E[:, 0]] == band[E[:, 1]]]
    links = coo_array((np.ones(len(inner_edges), bool), (inner_edges[:, 0], inner_edges[:, 1])), shape=(len(band), len(band)))
    component = connected_components(links, directed=False)[1]
    a, b = E.T
    onward = np.concatenate([component[a[band[a] < band[b]]], component[b[band[b] < band[a]]]])
    return ~np.isin(component, onward)


def neighbours(inside: Flags, E: Ints) -> Flags:
    """(vertex,) whether a vertex is on an edge that has an end inside; the vertices inside that have edges are among them.

    inside : (vertex,)
    E      : (edge, 2) vertices
    """
    out = np.zeros(len(inside), dtype=bool)
    out[E[inside[E].any(axis=1)]] = True
    return out


def components(inside: Flags, E: Ints) -> Ints:
    """(vertex,) number of the connected component of each vertex inside, −1 outside.

    inside : (vertex,)
    E      : (edge, 2) vertices
    """
    inner_edges = E[inside[E].all(axis=1)]
    links = coo_array(
        (np.ones(len(inner_edges), bool), (inner_edges[:, 0], inner_edges[:, 1])), shape=(len(inside), len(inside))
    )
    component = connected_components(links, directed=False)[1].astype(np.int64)
    return np.where(inside, component, -1)


def _large(candidates: Ints, component: Ints, area: Floats, least: float) -> Ints:
    """The components that have at least this share of the area of the largest among them."""
    size = np.array([area[component == c].sum() for c in candidates])
    return candidates[size >= least * size.max(initial=0.0)] if len(candidates) else candidates
