"""Where every vertex of an interval's reference is in one frame, by geodesic coordinates."""

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping, GeodesicMappingParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.paper_2014.geodesic_coordinates import nearest_in_coordinates, own_tips


@task(over="interval/frame", along=IntervalReference)
def geodesic_mapping(
    middle: IntervalReference,
    coordinates: GeodesicCoordinates,
    tips: Extrema,
    connectivity: Connectivity,
    before: GeodesicMapping | None,
    params: GeodesicMappingParams,
) -> GeodesicMapping:
    """Finds the vertices with the nearest geodesic coordinates, frame after frame from the reference (2014, Eqs. 5–6)."""
    if before is None or connectivity.fixed:
        return _itself(middle)
    row = own_tips(middle.trail, tips.stems[:, -1])
    X = np.full((len(row), coordinates.distance.shape[1]), np.nan)
    X[row >= 0] = coordinates.distance[row[row >= 0]]
    image, away = nearest_in_coordinates(before.place, X)
    return GeodesicMapping(
        image=image, away=away, place=before.place if params.order == "direct" else _moved(before.place, X, image)
    )


def _itself(middle: IntervalReference) -> GeodesicMapping:
    """The reference in its own frame, and in every frame of a sequence whose vertices are tracked already (Sec. 7)."""
    every = np.arange(len(middle.vertices))
    return GeodesicMapping(image=every, place=middle.distance, away=np.zeros(len(every)))


def _moved(place: Floats, X: Floats, image: NDArray[np.integer]) -> Floats:
    """Coordinates of the images; what a frame does not see, coordinates being invariant, stays as it was."""
    there = np.where(image >= 0, X[:, image], np.nan)
    return np.where(np.isnan(there), place, there)
