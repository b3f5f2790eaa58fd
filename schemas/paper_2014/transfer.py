"""The way between a frame and the mesh of the finished skeleton, there and back, interval by interval."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import INPUT_VERTEX, VERTEX, XYZ


class Transfer(Artifact):
    """The way over an interval's aligned mesh and the cuts."""

    corner: Annotated[Ints, Array("int32", INPUT_VERTEX)]
    """Vertex of the skeleton's mesh, −1 for a vertex that cleaning dropped, or where the way is broken."""
    distance: Annotated[Floats, Array("float64", INPUT_VERTEX, unit="length", finite=False)]
    """From the vertex to the aligned mesh's nearest; NaN where there is none."""
    place: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length", finite=False)]
    """Where every vertex of the skeleton's mesh is in the frame; NaN where the way is broken."""
