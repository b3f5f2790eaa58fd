"""The surface of one frame's volume: that of the visual hull, or of a volume as it was given."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import CORNER, FACE, VERTEX, XYZ


class IsosurfaceParams(Params):
    """Where the surface lies in a volume that is given; a hull's is at distance 0."""

    level: float | None = None
    """Value at the surface; None takes 0 where there are negative values, else halfway between least and largest."""
    smoothing: float = Field(default=1.0, ge=0, le=10)
    """Voxels over which a volume of two values, inside and outside, is smoothed."""


class Isosurface(Artifact):
    """A closed surface by marching cubes, before cleaning."""

    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Position of every vertex."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """The three corners of every face, counter-clockwise from outside."""
    cut: int = 0
    """Points on the border of the grid that are inside: there the body goes on beyond the volume, and was closed."""
