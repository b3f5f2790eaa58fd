"""An input mesh with few vertices, for the player of the report."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import CORNER, FACE, SAMPLE, VERTEX, XYZ


class CoarseMeshParams(Params):
    """How much of an input mesh the player of the report shows."""

    vertices: int = Field(default=2500, ge=50)
    """Most vertices of an input mesh in the player."""


class CoarseMesh(Artifact):
    """Some vertices of one frame's mesh, and the point of the reference that each belongs to."""

    size: int
    """Vertices of the whole mesh."""
    limit: int
    """Vertices that were asked for at most."""
    extent: tuple[float, ...]
    """Extent of the whole mesh along x, y and z, length."""
    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Positions of the vertices that are left."""
    reference_face: Annotated[Ints, Array("int32", VERTEX)]
    """The face of the reference that each lies on, −1 where it lies on none."""
    reference_corner: Annotated[Ints, Array("int32", VERTEX)]
    """The corner of that face which is nearest."""
    kept: Annotated[Ints, Array("int32", SAMPLE)]
    """Numbers of these vertices in the whole mesh; empty where they are those of an earlier frame."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Faces between them; empty where they are those of an earlier frame."""
