"""The rigid parts of the body and the rest of its surface (2014, Sec. 6.1 and 6.2)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import FRAME, PART, ROW, VERTEX, XYZ


class RigidPartsParams(Params):
    """How finely parts are sought, and what one must explain to stay."""

    rings: int = Field(default=50, ge=4, le=1000)
    """Rings in the longest distance from each leaf."""
    patches: int = Field(default=1000, ge=16, le=10_000)
    """Patches that the surface is cut into to begin with."""
    removal_cost: float = Field(default=0.0025, gt=0)
    """By how much the motion would be missed without a part, share of the root of the area; more for fewer parts."""


class RigidParts(Artifact):
    """Which vertex of the reference mesh belongs to which rigid part, and how the parts move."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """Part of every vertex of the reference mesh, that moves most like it; no vertex is without one."""
    rigid: Annotated[Floats, Array("float64", VERTEX)]
    """Share of each vertex's motion that its part alone explains: 1 on bones, less where the surface blends."""
    rotation: Annotated[Floats, Array("float64", FRAME, PART, ROW, XYZ)]
    """Of every part from the reference mesh to each frame."""
    translation: Annotated[Floats, Array("float64", FRAME, PART, XYZ, unit="length")]
    """x(t) = rotation · v + translation for a vertex v of the reference mesh."""
    residual: Annotated[Floats, Array("float64", FRAME, PART, unit="length")]
    """Root mean square of what the part's motion leaves of its clearly rigid vertices' motion."""
