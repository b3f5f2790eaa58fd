"""The reference mesh of one interval."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.paper_2014.interval_reference import middle_frame


@task(over="interval")
def interval_reference(
    index: Index,
    mesh: Mapping[int, Mesh],
    geodesics: Mapping[int, Geodesics],
    geodesic_coordinates: Mapping[int, GeodesicCoordinates],
    leaves: Leaves,
    connectivity: Connectivity,
) -> IntervalReference:
    """Takes the frame at the middle of the interval as the reference that is aligned to the others (2014, Sec. 5.3).

    With fixed connectivity and one interval its extrema are the leaves, which are followed by their vertices (Sec. 7).
    """
    frames, (interval,) = tuple(mesh), index
    of_interval = np.flatnonzero(leaves.kept[interval])
    leaf, extremum = (
        _followed_by_vertex(frames, geodesic_coordinates)
        if connectivity.fixed and len(leaves.kept) == 1
        else (of_interval, leaves.rows[np.ix_(of_interval, np.searchsorted(leaves.frames, frames))])
    )
    position = middle_frame(extremum >= 0)
    frame, row = frames[position], extremum[:, position]
    area, coordinates = geodesics[frame].area, geodesic_coordinates[frame]
    return IntervalReference(
        frames=frames,
        frame=frame,
        vertices=mesh[frame].vertices,
        faces=mesh[frame].faces,
        area=area,
        size=float(np.sqrt(area.sum())),
        leaf=leaf,
        leaf_vertex=_of_leaves(coordinates.extrema, row, -1),
        coordinates=_of_leaves(coordinates.distance, row, np.nan),
        extremum=extremum,
        tracked=connectivity.fixed,
    )


def _followed_by_vertex(
    frames: tuple[int, ...], coordinates: Mapping[int, GeodesicCoordinates]
) -> tuple[NDArray[np.integer], NDArray[np.integer]]:
    """(leaf,) the extrema of the middle frame, and (leaf, frame) which extrema they are: known in that frame only."""
    middle = middle_frame(np.ones((1, len(frames)), dtype=bool))
    leaf = np.arange(len(coordinates[frames[middle]].extrema))
    extremum = np.full((len(leaf), len(frames)), -1)
    extremum[:, middle] = leaf
    return leaf, extremum


def _of_leaves(values: NDArray[np.generic], row: NDArray[np.integer], missing: float) -> NDArray[np.generic]:
    """The values of each leaf's extremum; `missing` for a leaf that is not seen."""
    out = np.full((len(row), *values.shape[1:]), missing, values.dtype)
    out[row >= 0] = values[row[row >= 0]]
    return out
