"""The correspondence between a frame and the model mesh, over the interval's alignment and the cuts (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import INPUT_VERTEX, VERTEX, XYZ


class Transfer(Artifact):
    """The vertices of the frame on the model mesh, and the vertices of the model mesh in the frame."""

    model_vertex: Annotated[Ints, Array("int32", INPUT_VERTEX)]
    """Vertex of the model mesh; −1 for a vertex that cleaning dropped, and where no map over the cuts leads there."""
    distance: Annotated[Floats, Array("float64", INPUT_VERTEX, unit="length", finite=False)]
    """From the vertex to the nearest vertex of the aligned mesh that has one; NaN where there is none."""
    model_position: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length", finite=False)]
    """Where every vertex of the model mesh is in the frame; NaN where no map over the cuts reaches the frame's interval."""
    tracked: bool
    """Whether the sequence has fixed connectivity, so that known positions are exact."""
