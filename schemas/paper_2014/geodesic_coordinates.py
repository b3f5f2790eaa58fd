"""Geodesic coordinates of one frame's vertices (2014, Sec. 5.2, Eq. 4)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import LEAF, VERTEX


class GeodesicCoordinates(Artifact):
    """The distance of every vertex to each of the frame's tips; which tip is which leaf is the intervals' to say."""

    tips: Annotated[Ints, Array("int32", LEAF)]
    """The vertex of each of the frame's tips, in the order of `Tips`."""
    distance: Annotated[Floats, Array("float64", LEAF, VERTEX, unit="length", finite=False)]
    """Over the surface; NaN outside the largest component."""
