"""Where every vertex of an interval's reference is in one frame, by geodesic coordinates."""

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.connectivity import Connectivity
from kinetree.schemas.coordinates import Coordinates
from kinetree.schemas.matching import Matching, MatchingParams
from kinetree.schemas.middle import Middle
from kinetree.schemas.tips import Tips
from kinetree.tasks.numerics.mesoscopic.coordinates import nearest_in_coordinates, own_tips


@task(over="interval/frame", along=Middle)
def matching(
    middle: Middle,
    coordinates: Coordinates,
    tips: Tips,
    connectivity: Connectivity,
    before: Matching | None,
    params: MatchingParams,
) -> Matching:
    """Finds the vertices with the nearest geodesic coordinates, frame after frame from the reference (2014, Eqs. 5–6)."""
    if before is None or connectivity.fixed:
        return _itself(middle)
    row = own_tips(middle.trail, tips.stems[:, -1])
    X = np.full((len(row), coordinates.distance.shape[1]), np.nan)
    X[row >= 0] = coordinates.distance[row[row >= 0]]
    image, away = nearest_in_coordinates(before.place, X)
    return Matching(image=image, away=away, place=before.place if params.order == "direct" else _moved(before.place, X, image))


def _itself(middle: Middle) -> Matching:
    """The reference in its own frame, and in every frame of a sequence whose vertices are tracked already (Sec. 7)."""
    every = np.arange(len(middle.vertices))
    return Matching(image=every, place=middle.distance, away=np.zeros(len(every)))


def _moved(place: Floats, X: Floats, image: NDArray[np.integer]) -> Floats:
    """Coordinates of the images; what a frame does not see, coordinates being invariant, stays as it was."""
    there = np.where(image >= 0, X[:, image], np.nan)
    return np.where(np.isnan(there), place, there)
