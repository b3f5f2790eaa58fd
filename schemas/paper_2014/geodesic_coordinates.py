"""Geodesic coordinates of one frame's vertices (2014, Sec. 5.2, Eq. 4)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import LEAF, VERTEX


class GeodesicCoordinates(Artifact):
    """The distance of every vertex to each of the frame's extrema; `IntervalReference` says which extremum is which leaf."""

    extrema: Annotated[Ints, Array("int32", LEAF)]
    """The vertex of each of the frame's extrema, in the order of `Extrema`."""
    distance: Annotated[Floats, Array("float64", LEAF, VERTEX, unit="length", finite=False)]
    """Geodesic distance; NaN outside the largest component."""
