"""The surface of a signed distance on a grid, by marching cubes (2009, Sec. 2, step 2)."""

import numpy as np
from scipy.ndimage import distance_transform_edt, gaussian_filter
from skimage.measure import marching_cubes

from kinetree.errors import HullError
from kinetree.tasks.numerics.arrays import Faces, Flags, Floats, Lengths
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.input.hull import Field
from kinetree.tasks.numerics.input.volumes import Grid

NEAREST = 0.02
"""Least magnitude of a value, in steps of the grid: the surface moves by less than a fiftieth of a voxel, and no two vertices
fall together at a grid point."""


def isosurface(field: Field) -> tuple[Floats, Faces]:
    """Closed surface between the grid points inside and those outside; the grid is taken to lie in air.

    Lewiner's table keeps the topology of the trilinear field, so that no edge has more than two faces. All components are
    kept: which are the body is decided where meshes are cleaned.

    field   : positive inside
    returns : V (vertex, xyz) · F (face, corner) counter-clockwise from outside
    raises  : HullError if no value is positive
    """
    values = np.pad(field.values, 1, constant_values=-1.0)
    step = float(field.spacing.min())
    air = -max(step, float(-values.min()))
    values[[0, -1]], values[:, [0, -1]], values[:, :, [0, -1]] = air, air, air
    if not (values > 0.0).any():
        raise HullError("the volume has no point inside the body")
    V, F, _, _ = marching_cubes(_clear_of_zero(values, np.float32(NEAREST * step)), 0.0, gradient_direction="ascent")
    V = field.origin + (V.astype(np.float64) - 1.0) * field.spacing
    return V, np.ascontiguousarray(F, dtype=np.int32)


def signed_distance(grid: Grid, level: float | None, smoothing: float) -> tuple[Field, int]:
    """A volume as it was given, as a field that is positive inside and about a distance near the surface.

    The body lies in air, so that the side that most of the grid's border is on is outside. A volume of two values is
    occupancy, whose steps are smoothed away; any other has its surface at `level`.

    level     : None takes 0 where there are negative values, half of the largest elsewhere
    smoothing : for occupancy, standard deviation in voxels
    returns   : the field · how many points of the grid's border are inside, where the body is cut
    raises    : HullError if all values are on one side of the level
    """
    values = np.asarray(grid.values, dtype=np.float32)
    lowest, highest = float(values.min()), float(values.max())
    at = level if level is not None else 0.0 if lowest < 0.0 < highest else 0.5 * (lowest + highest)
    values = values - np.float32(at)
    border = np.ones(values.shape, dtype=np.bool_)
    border[1:-1, 1:-1, 1:-1] = False
    if 2 * int((values[border] > 0.0).sum()) > int(border.sum()):
        values = -values
    inside = values > 0.0
    if not inside.any() or inside.all():
        raise HullError(f"all values of the volume lie on one side of the level {at:g}, from {lowest:g} to {highest:g}")
    if ((values == values.min()) | (values == values.max())).all():
        return Field(_from_occupancy(inside, smoothing, grid.spacing), grid.origin, grid.spacing), int(inside[border].sum())
    values *= np.float32(grid.spacing.min() / _step_across(values))
    return Field(values, grid.origin, grid.spacing), int(inside[border].sum())


def _from_occupancy(inside: Flags, smoothing: float, spacing: Floats) -> Lengths:
    """Signed distance to where occupancy changes, smoothed; the least spacing inside and outside where it is farther."""
    padded = np.pad(inside, 1)
    least = float(spacing.min())
    away = distance_transform_edt(padded, spacing) - distance_transform_edt(~padded, spacing)
    away -= 0.5 * least * np.sign(away)
    smooth = gaussian_filter(away, smoothing) if smoothing > 0.0 else away
    return np.ascontiguousarray(smooth[1:-1, 1:-1, 1:-1], dtype=np.float32)


def _step_across(values: Lengths) -> float:
    """Median difference between neighbours on different sides."""
    steps = []
    for axis in range(3):
        low, high = np.delete(values, -1, axis), np.delete(values, 0, axis)
        steps.append(np.abs(high - low)[(low > 0.0) != (high > 0.0)])
    return float(np.median(np.concatenate(steps)))


@compiled
def _clear_of_zero(values, least):  # type: ignore[no-untyped-def]
    """The values with magnitudes below `least` raised to it, signs kept."""
    flat = values.reshape(-1)
    for i in range(len(flat)):
        if abs(flat[i]) < least:
            flat[i] = least if flat[i] > 0.0 else -least
    return values
