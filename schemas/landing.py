"""For every vertex of the user's file the vertex on the mesh of the finished skeleton, interval by interval."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import INPUT_VERTEX


class Landing(Artifact):
    """The way over an interval's aligned mesh and the cuts."""

    corner: Annotated[Ints, Array("int32", INPUT_VERTEX)]
    """Vertex of the skeleton's mesh, −1 for a vertex that cleaning dropped, or where the way is broken."""
    distance: Annotated[Floats, Array("float64", INPUT_VERTEX, unit="length", finite=False)]
    """From the vertex to the aligned mesh's nearest; NaN where there is none."""
