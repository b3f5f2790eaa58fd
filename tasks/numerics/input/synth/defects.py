"""What reconstruction does to a surface: noise along the normals, and holes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.normals import vertex_normals


class NoiseSettings(NamedTuple):
    """What the noise is made of."""

    smooth_share: float = 0.4
    """Share of the variance that varies smoothly over the surface, as errors of silhouettes and stereo do."""
    waves: int = 32
    """Plane waves in the smooth part."""


_SETTINGS = NoiseSettings()


def roughened(V: Floats, F: Ints, sigma: float, wavelength: float, rng: np.random.Generator) -> Floats:
    """Vertices moved along their normals by noise of root mean square `sigma`, part white and part smooth.

    The smooth part is a sum of plane waves with random directions and lengths about `wavelength`.

    V          : (vertex, xyz); sigma, wavelength : its unit
    returns    : (vertex, xyz)
    """
    k = rng.normal(size=(3, _SETTINGS.waves)) * (2.0 * np.pi / wavelength / np.sqrt(3.0))
    smooth = np.cos(np.einsum("vi,iw->vw", V, k) + rng.uniform(0.0, 2.0 * np.pi, _SETTINGS.waves)).sum(axis=1)
    noise = np.sqrt(_SETTINGS.smooth_share) * smooth / np.sqrt(0.5 * _SETTINGS.waves)
    noise += np.sqrt(1.0 - _SETTINGS.smooth_share) * rng.normal(size=len(V))
    noise *= sigma / np.sqrt(np.mean(noise**2))
    return V + noise[:, None] * vertex_normals(V, F)


def punctured(V: Floats, F: Ints, count: int, radius: float, rng: np.random.Generator) -> tuple[Floats, Ints]:
    """The mesh with `count` holes: around random vertices, all faces within `radius` that hang together with them.

    V       : (vertex, xyz), F : (face, corner); radius : the unit of V
    returns : the vertices that still have a face, in their order, and the faces
    """
    for centre in rng.choice(len(V), size=count, replace=False):
        near = np.linalg.norm(V - V[centre], axis=1) < radius
        near[centre] = True
        inside = near[F].all(axis=1) | (centre == F).any(axis=1)
        corners = F[inside]
        links = coo_matrix(
            (np.ones(2 * len(corners)), (corners[:, :2].ravel(), corners[:, 1:].ravel())), shape=(len(V), len(V))
        )
        _, patch = connected_components(links, directed=False)
        F = F[~(inside & (patch[F[:, 0]] == patch[centre]))]
    used = np.unique(F)
    new_index = np.full(len(V), -1, dtype=np.int64)
    new_index[used] = np.arange(len(used))
    return V[used], new_index[F]
