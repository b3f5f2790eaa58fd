"""The cone of each leaf of an interval, as annuli on the interval's reference (2014, Sec. 6.1.1.1)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import LEAF, VERTEX


class ConesParams(Params):
    """How wide annuli are."""

    annuli: int = Field(default=25, ge=2, le=1000)
    """Annuli in the longest distance from each leaf; the paper has 25."""


class Cones(Artifact):
    """The annulus of every vertex in the cone of each leaf; cones of a tree-shaped body overlap (Fig. 7)."""

    annuli: int
    """Annuli in the longest distance from each leaf."""
    annulus: Annotated[Ints, Array("int32", LEAF, VERTEX)]
    """Annulus k of the vertex in each leaf's cone, 0 around the leaf; −1 beyond the cone, and for a leaf not seen."""
    mu_range: Annotated[Floats, Array("float64", LEAF, unit="length³")]
    """Range of μ in each cone; of two equally long cones the one with the wider range is reliable (Sec. 6.1.1.3)."""
