"""Surfaces of implicit figures: marching cubes on a turned, shifted grid whose spacing yields a number of vertices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial.transform import Rotation
from skimage.measure import marching_cubes

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.input.synth.implicit import Cones, extent, grid_values


class SurfacingSettings(NamedTuple):
    """How the grid is chosen and kept clear of the surface."""

    snap: float = 0.02
    """Share of the spacing; a value closer to zero is pushed away from it: the surface moves by less than a fiftieth of a
    voxel, and no two vertices fall together at a grid point."""
    coarseness: tuple[float, ...] = (2.0, 1.2)
    """Spacings of the grids on which crossings are counted, one after the other, as multiples of the last estimate."""


_SETTINGS = SurfacingSettings()


def surface(cones: Cones, spacing: float, rng: np.random.Generator, vertices: int | None = None) -> tuple[Floats, Ints]:
    """Mesh of the figure's surface on a grid with a random rotation and sub-voxel shift.

    Marching cubes puts one vertex on every grid edge that crosses the surface. Their number falls with the square of
    the spacing, so counting the crossings on a coarser grid says which spacing yields `vertices`; a second grid, hardly
    coarser, corrects what the first lost of thin limbs.

    spacing  : of the grid, the figure's unit; a first guess when `vertices` is given
    vertices : wanted number
    returns  : (vertex, xyz) in the figure's unit, (face, corner) turning counter-clockwise seen from outside
    """
    turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    shift = rng.random(3)
    A, D, side, bow = (_turned(X, turn) for X in (cones.A, cones.D, cones.side, cones.bow))
    turned = cones._replace(A=A, D=D, side=side, bow=bow)
    if vertices is not None:
        for coarseness in _SETTINGS.coarseness:
            coarse, _ = _sampled(turned, coarseness * spacing, shift)
            spacing *= coarseness * float(np.sqrt(max(_crossings(coarse), 1) / vertices))
    field, origin = _sampled(turned, spacing, shift)
    V, F, _, _ = marching_cubes(_clear_of_zero(field, _SETTINGS.snap * spacing), 0.0, gradient_direction="descent")
    V, F = largest_component(V.astype(np.float64), F.astype(np.int64))
    return _turned(origin + spacing * V, turn.T), F


def largest_component(V: Floats, F: Ints) -> tuple[Floats, Ints]:
    """The component that encloses the largest volume: a figure is one solid, and the rest is an artefact of sampling.

    Where limbs touch they enclose pockets that no one sees (their components face inwards, their volume is negative),
    and a tip thinner than a voxel may come off between grid points.

    V       : (vertex, xyz), F : (face, corner) counter-clockwise seen from outside the solid
    returns : the same, vertices renumbered in their order
    """
    links = coo_matrix((np.ones(2 * len(F)), (F[:, :2].ravel(), F[:, 1:].ravel())), shape=(len(V), len(V)))
    count, component = connected_components(links, directed=False)
    a, b, c = (V[F[:, k]] - V[0] for k in range(3))
    volume = np.bincount(component[F[:, 0]], np.einsum("fi,fi->f", a, np.cross(b, c)), minlength=count)
    largest = component == np.argmax(volume)
    new_index = np.cumsum(largest, dtype=np.int64) - 1
    return V[largest], new_index[F[largest[F[:, 0]]]]


def spacing_for(cones: Cones, vertices: int) -> float:
    """First guess of the grid spacing that yields a number of vertices: 1.5 per voxel face of the limbs' area.

    A surface of area A crosses A·mean(|n_x| + |n_y| + |n_z|) / h² grid edges, 1.5 A / h² when its normals are spread
    evenly over the sphere (Cauchy–Crofton).

    returns : the figure's unit
    """
    area = float(np.sum(2.0 * np.pi * cones.table.mean(axis=1) * np.linalg.norm(cones.D, axis=1)))
    return float(np.sqrt(1.5 * area / vertices))


def _turned(X: Floats, turn: Floats) -> Floats:
    """Rows of X times a rotation, without BLAS: its sums may depend on the number of threads."""
    return np.ascontiguousarray(np.einsum("ij,vj->vi", turn, X))


def _sampled(cones: Cones, spacing: float, shift: Floats) -> tuple[Floats, Floats]:
    """Field on the smallest grid that holds the figure with two voxels to spare, and the grid's origin."""
    low, high = extent(cones)
    origin = low - (2.0 + shift) * spacing
    nx, ny, nz = (int(n) for n in np.ceil((high - origin) / spacing) + 3)
    return grid_values(cones, origin, spacing, (nx, ny, nz), 2.0 * spacing), origin


@compiled
def _crossings(field):  # type: ignore[no-untyped-def]
    """Grid edges whose ends lie on different sides of the surface."""
    count = 0
    for i in range(field.shape[0] - 1):
        for j in range(field.shape[1] - 1):
            for k in range(field.shape[2] - 1):
                inside = field[i, j, k] < 0.0
                count += inside != (field[i + 1, j, k] < 0.0)
                count += inside != (field[i, j + 1, k] < 0.0)
                count += inside != (field[i, j, k + 1] < 0.0)
    return count


@compiled
def _clear_of_zero(field, least):  # type: ignore[no-untyped-def]
    """The field with magnitudes below `least` raised to it, signs kept."""
    flat = field.reshape(-1)
    for i in range(len(flat)):
        if abs(flat[i]) < least:
            flat[i] = -least if flat[i] < 0.0 else least
    return field
