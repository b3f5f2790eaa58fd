"""Joints where the surface is not rigid, bones between them, and which of these are redundant (2014, Sec. 6.3.1 and 6.3.2)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints
from kinetree.schemas.dims import AREA, BONE, END, FRAME, VERTEX, XYZ


class Bones(Artifact):
    """Partial kinematic structures, integrated (Fig. 15)."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    part: Annotated[Ints, Array("int32", AREA)]
    """The rigid part of each area; adjacent rigid areas without a joint between them are one part. −1 for joints."""
    centroid: Annotated[Floats, Array("float64", FRAME, AREA, XYZ, unit="length", finite=False)]
    """Centroid of each area in every frame; NaN in intervals in which nothing of it is seen."""
    bone: Annotated[Ints, Array("int32", BONE, END)]
    """Bones between joints whose areas are adjacent to each other or to the same rigid part."""
    bone_part: Annotated[Ints, Array("int32", BONE)]
    """The part between, −1 where the areas are adjacent to each other only."""
    variation: Annotated[Floats, Array("float64", BONE, unit="length", finite=False)]
    """Standard deviation of each bone's length over the frames."""
    in_tree: Annotated[Bools, Array("bool", BONE)]
    """Whether it is in the minimum spanning tree on the variation of lengths; the others are redundant."""
    model_vertex: Annotated[Ints, Array("int32", VERTEX)]
    """For every vertex of all references, one after another, the corresponding vertex of the model mesh; −1 for none."""
