"""The extrema of one frame: local maxima of μ that persist, at the ends of limbs (2014, Sec. 5.1)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import LEAF, LOOP, PEAK, STATION, XYZ


class ExtremaParams(Params):
    """What counts as an extremum."""

    threshold: float = Field(default=0.20, gt=0, lt=1)
    """Share of the range of μ by which one must descend from an extremum before a higher one can be reached."""
    roundness: float = Field(default=0.05, ge=0, lt=1)
    """A body on which μ varies by less than this share of its maximum is round and has no extrema."""
    stations: int = Field(default=4, ge=1, le=100)
    """Points along a limb, from its root to its end, by which it is followed."""


class Extrema(Artifact):
    """The extrema of one frame, most persistent first; none on a ball."""

    vertices: Annotated[Ints, Array("int32", LEAF)]
    """The vertex of each extremum."""
    persistence: Annotated[Floats, Array("float64", LEAF)]
    """Share of the range of μ, above the threshold to 1."""
    stems: Annotated[Floats, Array("float64", LEAF, STATION, XYZ, unit="length")]
    """Centres of each extremum's limb from its root to its end, the extremum itself last."""
    normals: Annotated[Floats, Array("float64", LEAF, XYZ)]
    """Outward unit normal at each extremum."""
    value: Annotated[Floats, Array("float64", LEAF)]
    """μ / area^1.5 at each extremum."""
    peaks: Annotated[Floats, Array("float64", PEAK)]
    """Persistences of all maxima above a fiftieth of the range of μ, highest first."""
    loops: Annotated[Floats, Array("float64", LOOP)]
    """How far each loop of the surface reaches, share of the range of μ, longest first."""
    size: float
    """Root of the surface's area, length."""
    centre: tuple[float, float, float]
    """The surface's centre of area, length."""
    euler: int
    """Vertices − edges + faces of the cleaned surface."""
    components: int
    """Components of the cleaned surface."""
