"""The geodesic mapping from an interval's reference to one of its frames (2014, Sec. 5.3, Eqs. 5–6)."""

from typing import Annotated, Literal

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import LEAF, VERTEX


class GeodesicMappingParams(Params):
    """Which frames are compared."""

    order: Literal["composed", "direct"] = "composed"
    """composed: each frame with the one before, mappings composed, as in the paper; direct: each frame with the reference."""


class GeodesicMapping(Artifact):
    """For every vertex of the reference one of the frame's own vertices, without regard to connectivity."""

    image: Annotated[Ints, Array("int32", VERTEX)]
    """The frame's vertex; −1 outside the reference's largest component, and everywhere if no leaf is seen in both."""
    coordinates: Annotated[Floats, Array("float64", LEAF, VERTEX, unit="length", finite=False)]
    """Geodesic coordinates with which the next frame is compared: of the images or, if direct, of the reference."""
    coordinate_distance: Annotated[Floats, Array("float64", VERTEX, unit="length", finite=False)]
    """Distance of Eq. 6 between each image and the coordinates searched for; 0 in the reference, NaN without an image."""
