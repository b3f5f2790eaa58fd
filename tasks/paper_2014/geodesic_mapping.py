"""The image of every vertex of an interval's reference in one frame, by geodesic coordinates."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.paper_2014.geodesic_coordinates import GeodesicCoordinates
from kinetree.schemas.paper_2014.geodesic_mapping import GeodesicMapping, GeodesicMappingParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.numerics.paper_2014.geodesic_mapping import image_coordinates, nearest_in_coordinates


@task(over="interval/frame", along=IntervalReference)
def geodesic_mapping(
    index: Index,
    interval_reference: IntervalReference,
    geodesic_coordinates: GeodesicCoordinates,
    previous: GeodesicMapping | None,
    params: GeodesicMappingParams,
) -> GeodesicMapping:
    """Finds the vertices with the nearest geodesic coordinates, frame after frame from the reference (2014, Eqs. 5–6)."""
    reference = interval_reference
    if previous is None or reference.tracked:
        return _identity(reference)
    row = reference.extremum[:, reference.frames.index(index[-1])]
    X = np.full((len(row), geodesic_coordinates.distance.shape[1]), np.nan)
    X[row >= 0] = geodesic_coordinates.distance[row[row >= 0]]
    image, distance = nearest_in_coordinates(previous.coordinates, X)
    is_direct = params.order == "direct"
    coordinates = previous.coordinates if is_direct else image_coordinates(previous.coordinates, X, image)
    return GeodesicMapping(image=image, coordinates=coordinates, coordinate_distance=distance)


def _identity(reference: IntervalReference) -> GeodesicMapping:
    """Every vertex is its own image: in the reference's own frame, and in all frames if vertices are tracked (Sec. 7)."""
    count = len(reference.vertices)
    return GeodesicMapping(image=np.arange(count), coordinates=reference.coordinates, coordinate_distance=np.zeros(count))
