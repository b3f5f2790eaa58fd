"""The rigid parts of the body, and the cut that they were made from (2014, Sec. 6.1 and 6.2)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import ANNULUS, CONE, FRAME, PART, REMOVAL, ROW, VERTEX, XYZ


class CutParams(Params):
    """How finely the surface is cut, and what removing a part must cost for it to stay."""

    rings: int = Field(default=50, ge=4, le=1000)
    """Rings in the longest distance from each leaf."""
    patches: int = Field(default=1000, ge=16, le=10_000)
    """Patches that the surface is cut into at first."""
    removal_cost: float = Field(default=0.0025, gt=0)
    """Motion left unexplained without a part, share of the root of the area; a part that costs less is removed."""


class RigidPartsParams(CutParams):
    """How the body is cut, and how often."""

    cuts: int = Field(default=4, ge=1, le=50)
    """Poses in which the body is cut; joints are the mean over all cuts, and know how far these are apart."""


class RigidParts(Artifact):
    """Which vertex of the reference mesh belongs to which rigid part, how the parts move, and how they were found.

    A reference mesh of more than 14,000 vertices is cut at a sample of them: every other vertex has the values of the nearest
    vertex of the sample.
    """

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """Part of every vertex of the reference mesh, the one that moves most like it; every vertex has one."""
    rigid: Annotated[Floats, Array("float64", VERTEX)]
    """Share of each vertex's motion that its part alone explains: 1 on bones, less where the surface blends."""
    rotation: Annotated[Floats, Array("float64", FRAME, PART, ROW, XYZ)]
    """Of every part from the reference mesh to each frame."""
    translation: Annotated[Floats, Array("float64", FRAME, PART, XYZ, unit="length")]
    """x(t) = rotation · v + translation for a vertex v of the reference mesh."""
    residual: Annotated[Floats, Array("float64", FRAME, PART, unit="length")]
    """Root mean square distance between the part's clearly rigid vertices and where its motion carries them."""
    tip: Annotated[Ints, Array("int32", CONE)]
    """Vertex of the reference mesh around which each cone lies."""
    cone: Annotated[Ints, Array("int32", VERTEX)]
    """Cone in which each vertex was cut; −1 in no cone, −2 in several with no leaf clearly nearest: cut as the trunk is."""
    ring: Annotated[Ints, Array("int32", VERTEX)]
    """Annulus of every vertex in its cone, 0 around the tip; −1 outside the cones."""
    run: Annotated[Ints, Array("int32", CONE, ANNULUS)]
    """Rigid run that the optimal cut put each annulus in, ascending from 0; −1 beyond the cone's last annulus."""
    merge: Annotated[Floats, Array("float64", CONE, ANNULUS, finite=False)]
    """Merge error at each annulus' far border, share of the root of the area; NaN from the cone's last annulus on."""
    merge_threshold: float
    """Merge error above which two tenths of a cone are cut apart, share of the root of the area."""
    initial: Annotated[Ints, Array("int32", VERTEX)]
    """Part of every vertex in the first cut, which has too many parts on purpose."""
    removed: Annotated[Ints, Array("int32", REMOVAL)]
    """Parts of the first cut that were eliminated, in this order."""
    cost: Annotated[Floats, Array("float64", REMOVAL)]
    """What removing each cost: motion left unexplained without it, share of the root of the area."""
    cost_threshold: float
    """Cost from which on a part stays; above the parameter where the body is soft or badly aligned."""
    origin: Annotated[Ints, Array("int32", PART)]
    """Part of the first cut that each rigid part has grown from, the same for parts that were cut apart; parts that are in
    neither list lost all their vertices."""
