"""Geodesic coordinates of one frame's vertices (2014, Sec. 5.2, Eq. 4)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import LEAF, VERTEX


class GeodesicCoordinatesParams(Params):
    """How exactly distances are measured."""

    exact: float = Field(default=0.0, ge=0, le=10_000)
    """Mean edges around each tip in which distances are exact, which takes long; elsewhere 0.2 % too long in the mean."""


class GeodesicCoordinates(Artifact):
    """The distance of every vertex to each of the frame's extrema; `IntervalReference` says which extremum is which leaf."""

    extrema: Annotated[Ints, Array("int32", LEAF)]
    """The vertex of each of the frame's extrema, in the order of `Extrema`."""
    distance: Annotated[Floats, Array("float64", LEAF, VERTEX, unit="length", finite=False)]
    """Geodesic distance; NaN outside the largest component."""
