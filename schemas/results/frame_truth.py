"""One frame held against the truth (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import JOINT, PAIR


class FrameTruth(Artifact):
    """Which true parts the vertices of each part have, and how the true joints lie in the body."""

    frame: int
    """Source frame number."""
    known: bool
    """Whether the true part of every vertex is known."""
    part: Annotated[Ints, Array("int32", PAIR)]
    """A joint of the skeleton that carries vertices of the frame."""
    carrier: Annotated[Ints, Array("int32", PAIR)]
    """The true joint that carries the same vertices."""
    bone_end: Annotated[Ints, Array("int32", PAIR)]
    """The other end of the one true bone that they follow; −1 where the joint carries all its bones."""
    count: Annotated[Ints, Array("int64", PAIR)]
    """How many such vertices there are."""
    inside: bool
    """Whether the true joints can be the joints of the body, by their place and size."""
    radius: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Half the body's diameter at every true joint."""
