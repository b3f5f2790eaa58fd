"""Where the geodesic mapping takes every vertex of an interval's reference in one of its frames (2014, Sec. 5.3, Eqs. 5–6)."""

from typing import Annotated, Literal

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import LEAF, VERTEX


class GeodesicMappingParams(Params):
    """How far apart in time the frames are that are compared."""

    order: Literal["composed", "direct"] = "composed"
    """composed: from frame to frame, one mapping after the other, as the paper has it; direct: each with the reference."""


class GeodesicMapping(Artifact):
    """For every vertex of the reference one of the frame's own vertices, without regard to their connections."""

    image: Annotated[Ints, Array("int32", VERTEX)]
    """The frame's vertex; −1 outside the reference's largest component, and everywhere if no leaf is seen in both."""
    place: Annotated[Floats, Array("float64", LEAF, VERTEX, unit="length", finite=False)]
    """What the next frame is compared with: geodesic coordinates of the images or, if direct, of the reference."""
    away: Annotated[Floats, Array("float64", VERTEX, unit="length", finite=False)]
    """Distance in coordinates between each image and what it was found by; 0 in the reference, NaN without an image."""
