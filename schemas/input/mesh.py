"""One frame's surface after cleaning, what was done to it, and the way back to the user's own vertices."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import CORNER, FACE, INPUT_VERTEX, VERTEX, XYZ


class MeshParams(Params):
    """How much of a captured surface counts as the body."""

    merge: float = Field(default=1e-7, ge=0, lt=0.1)
    """Vertices closer than this share of the bounding box's diagonal are one; 0 merges only equal ones."""
    component_share: float = Field(default=0.05, ge=0, le=1)
    """Components below this share of the area are debris; the largest always stays."""


class Cleaning(Params):
    """What cleaning one mesh did, and what the mesh is like now."""

    merged: int = 0
    """Vertices welded to another."""
    unreferenced: int = 0
    """Vertices in no face, dropped."""
    degenerate: int = 0
    """Faces with a repeated corner, dropped."""
    duplicate: int = 0
    """Faces with the same corners as an earlier one, dropped."""
    needles: int = 0
    """Faces without height, kept so that no crack opens."""
    flipped: int = 0
    """Faces turned to agree with their neighbours and to look outwards."""
    components: int = 1
    """Components found."""
    components_kept: int = 1
    """Components that are the body."""
    share_kept: float = 1.0
    """Share of the area that the kept components have."""
    nested: int = 0
    """Components dropped because they lie inside another."""
    boundary_edges: int = 0
    """Edges with one face."""
    non_manifold_edges: int = 0
    """Edges with more than two faces."""
    disagreeing_edges: int = 0
    """Edges whose two faces cannot be made to agree."""
    euler: int = 2
    """Vertices − edges + faces: 2 for a closed body without handles, 2 less for each handle."""
    area: float = 0.0
    """Area of the body, length²."""
    volume: float | None = None
    """Volume of the body, length³; None where the surface is not closed."""


class Mesh(Artifact):
    """One frame's surface, cleaned; coordinates in the user's own frame and unit."""

    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Position of every vertex."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """The three corners of every face, counter-clockwise from outside."""
    vertex_of_input: Annotated[Ints, Array("int32", INPUT_VERTEX)]
    """For every vertex of the user's file the vertex it became, −1 where it was dropped."""
    cleaning: Cleaning
    """What was done to get here."""
