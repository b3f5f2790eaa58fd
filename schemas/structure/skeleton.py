"""The result of a run: a tree of joints, their positions in every frame, and the surface that follows them (2014, Sec. 6.3)."""

from typing import Annotated, Literal

import numpy as np

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import CORNER, FACE, FRAME, INFLUENCE, JOINT, ROW, VERTEX, XYZ


class ArticulatedBody(Artifact):
    """A tree of joints with a pose in every frame, and the surface that follows it.

    x_j(t) = x_p(t) + R_p(t) (rest_j − rest_p) for every joint j with parent p.
    The surface follows by linear blend skinning: x_v(t) = Σ_i w_vi [R_i(t) (v − rest_i) + x_i(t)].
    """

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    names: tuple[str, ...]
    """Name of every joint, readable, unique and the same on every run; parents come before children."""
    parents: tuple[int, ...]
    """Parent of every joint, −1 for the root, which is the first."""
    kinds: tuple[Literal["root", "joint", "leaf"], ...]
    """root: no parent; joint: turns against its parent; leaf: the end of a bone, turns with its parent."""
    positions: Annotated[Floats, Array("float64", FRAME, JOINT, XYZ, unit="length")]
    """Of every joint in every frame; bone lengths are the same in all."""
    rotation: Annotated[Floats, Array("float64", FRAME, JOINT, ROW, XYZ)]
    """From the reference pose to each frame, of the part that turns about the joint; a leaf has its parent's."""
    confidence: Annotated[Floats, Array("float64", FRAME, JOINT)]
    """How certain a joint's position in a frame is, 0 to 1."""
    rest: Annotated[Floats, Array("float64", JOINT, XYZ, unit="length")]
    """Position of every joint in the reference mesh."""
    degrees: Annotated[Floats, Array("float64", JOINT, unit="°")]
    """Range of the turning of each joint against its parent over the sequence; 0 for root and leaves."""
    drift: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Root mean square distance between the joint as one of its parts and as the other carries it."""
    support: Annotated[Ints, Array("int32", JOINT)]
    """Frames in which most of the surface of the joint's parts was seen and certain."""
    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """The reference mesh."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Its faces."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """The joint whose rigid part each vertex belongs to, −1 where the surface is not rigid."""
    influence: Annotated[Ints, Array("int32", VERTEX, INFLUENCE)]
    """The joints each vertex follows, heaviest first; a weight of 0 where there are fewer than four."""
    weight: Annotated[Floats, Array("float64", VERTEX, INFLUENCE)]
    """Skinning weights, not negative, summing to 1."""

    @property
    def lengths(self) -> Floats:
        """(joint,) from each joint to its parent, mesh unit; 0 for the root."""
        parent = np.maximum(self.parents, 0)
        length: Floats = np.where(np.array(self.parents) < 0, 0.0, np.linalg.norm(self.rest - self.rest[parent], axis=1))
        return length


class Skeleton(ArticulatedBody):
    """The result: the body in all frames, with what is known of time and unit."""

    fps: float | None
    """Frames a second; None where it is not known."""
    unit: str | None
    """Unit of all lengths; None where it is not known."""
