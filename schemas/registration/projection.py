"""The way from one frame's own input vertices to the reference mesh: how labels come back."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import CORNER, INPUT_VERTEX


class Projection(Artifact):
    """For every vertex of the user's file a point on the reference mesh."""

    face: Annotated[Ints, Array("int32", INPUT_VERTEX)]
    """Face of the reference mesh on which the vertex lies, −1 for a vertex that cleaning dropped."""
    share: Annotated[Floats, Array("float64", INPUT_VERTEX, CORNER)]
    """Barycentric shares of the face's corners, summing to 1; 0 where there is no face."""
    distance: Annotated[Floats, Array("float64", INPUT_VERTEX, unit="length", finite=False)]
    """From the vertex to that point on the aligned mesh; NaN where there is none."""
