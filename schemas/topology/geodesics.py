"""The integral of geodesic distance over one frame's surface (2014, Sec. 4, Eq. 1)."""

from typing import Annotated, Literal

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import BASE, VERTEX


class GeodesicsParams(Params):
    """How μ is summed."""

    sum: Literal["bases", "vertices"] = "bases"
    """bases: well-spread vertices weighted by the area around each; vertices: Eq. 1 to the letter, every vertex counting 1."""
    bases: int = Field(default=200, ge=1, le=100_000)
    """How many bases; 200 miss the integral over all vertices by less than 0.5 %."""
    least_share: float = Field(default=0.5, ge=0, le=1)
    """The largest component must have this share of the area; with less the frame shows no one body and fails."""


class Geodesics(Artifact):
    """μ of every vertex, and the bases it was summed over."""

    mu: Annotated[Floats, Array("float64", VERTEX, unit="length³", finite=False)]
    """Integral of geodesic distance; length × vertices for Eq. 1 to the letter; NaN outside the largest component."""
    area: Annotated[Floats, Array("float64", VERTEX, unit="length²")]
    """Area each vertex stands for: a third of the faces around it; 0 outside the largest component."""
    bases: Annotated[Ints, Array("int32", BASE)]
    """Vertices that were summed over, in the order of choice; empty where all were."""
    share: float
    """Share of the surface's area that the largest component has."""
