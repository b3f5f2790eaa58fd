"""The reference mesh of one interval."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.paper_2014.geodesic_coordinates import middle_frame


@task(over="interval")
def interval_reference(
    mesh: Mapping[int, Mesh],
    geodesics: Mapping[int, Geodesics],
    coordinates: Mapping[int, GeodesicCoordinates],
    intervals: Intervals,
    leaves: Leaves,
) -> IntervalReference:
    """Takes the frame at the middle of the interval as the reference all others are aligned to (2014, Sec. 5.3)."""
    frames = tuple(mesh)
    at = np.array([leaves.frames.index(t) for t in frames])
    leaf = np.flatnonzero(leaves.kept[intervals.begin.tolist().index(at[0])])
    rows = leaves.rows[np.ix_(leaf, at)]
    frame = frames[middle_frame(rows >= 0)]
    row = rows[:, frames.index(frame)]
    mine = coordinates[frame]
    return IntervalReference(
        frames=frames,
        frame=frame,
        vertices=mesh[frame].vertices,
        faces=mesh[frame].faces,
        area=geodesics[frame].area,
        size=float(np.sqrt(geodesics[frame].area.sum())),
        leaf=leaf,
        tip=_of(mine.tips, row, -1),
        distance=_of(mine.distance, row, np.nan),
        trail=np.where((rows >= 0)[:, :, None], leaves.positions[np.ix_(leaf, at)], np.nan),
    )


def _of(values: NDArray[np.generic], row: NDArray[np.integer], rest: float) -> NDArray[np.generic]:
    """Rows of an array, `rest` where there is none."""
    out = np.full((len(row), *values.shape[1:]), rest, values.dtype)
    out[row >= 0] = values[row[row >= 0]]
    return out
