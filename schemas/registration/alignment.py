"""The reference mesh in one frame, and a confidence of every vertex (2014, Sec. 5.3)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import VERTEX, XYZ


class Alignment(Artifact):
    """Where every vertex of the reference mesh is in this frame."""

    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Position of every vertex of the reference mesh."""
    residual: Annotated[Floats, Array("float64", VERTEX, unit="length")]
    """Distance of every vertex to the frame's surface, point to triangle; 0 for fixed connectivity."""
    stretch: Annotated[Floats, Array("float64", VERTEX)]
    """Length of the edges around every vertex against their length in the reference."""
    confidence: Annotated[Floats, Array("float64", VERTEX)]
    """Confidence of every vertex, 0 to 1: its weight in later steps."""
    uncovered: float
    """Share of the frame's surface that the body does not explain."""
    distance: float = 0.0
    """Median residual, length: what is missing in a frame does not make the rest worse."""
    unreliable: float = 0.0
    """Share of the vertices whose confidence is below a half."""
    given: bool = False
    """Whether the frame's own vertices are those of the reference (fixed connectivity), so that nothing was estimated."""
