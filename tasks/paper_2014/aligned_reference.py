"""The default's reference mesh as that of the one interval that a wholly aligned sequence is."""

from collections.abc import Mapping

import numpy as np

from kinetree.errors import ConfigError
from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.aligned_reference import AlignedReferenceParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.intervals import Intervals
from kinetree.tasks.numerics.paper_2014.geodesic_coordinates import geodesic_coordinates


@task(over="interval")
def aligned_reference(
    reference: Reference,
    geodesics: Mapping[int, Geodesics],
    extrema: Mapping[int, Extrema],
    intervals: Intervals,
    params: AlignedReferenceParams,
) -> IntervalReference:
    """Takes the default's reference mesh and the leaves of its frame; an aligned sequence has one connectivity (2014, Sec. 7).

    Raises ConfigError if the sequence is cut: one mesh serves all frames.
    """
    if len(intervals.begin) > 1:
        raise ConfigError(
            f"the sequence is cut into {len(intervals.begin)} intervals, but one alignment serves all frames: set"
            " intervals.rule to fixed and intervals.threshold to -1, which cuts nowhere"
        )
    frames, frame = tuple(geodesics), reference.frame
    vertex = extrema[frame].vertices[extrema[frame].persistence >= params.threshold].astype(np.int64)
    leaf, area = np.arange(len(vertex)), geodesics[frame].area
    extremum = np.full((len(leaf), len(frames)), -1)
    extremum[:, frames.index(frame)] = np.flatnonzero(extrema[frame].persistence >= params.threshold)
    return IntervalReference(
        frames=frames,
        frame=frame,
        vertices=reference.vertices,
        faces=reference.faces,
        area=area,
        size=float(np.sqrt(area.sum())),
        leaf=leaf,
        leaf_vertex=vertex,
        coordinates=geodesic_coordinates(np.array(reference.vertices), reference.faces, vertex),
        extremum=extremum,
        tracked=reference.fixed,
    )
