"""Last parts of limbs, and the trunk, on a few frames' surfaces, with a hinge at rings across them (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints
from kinetree.schemas.dims import FRAME, RING, ROW, XYZ


class EndRings(Artifact):
    """How the part of every ring lies in a few frames, as one piece and with a hinge at the ring.

    Rings are those across the last parts of limbs of the agreed tree, then those across the trunk, part by part, nearest to the
    border first.
    """

    frame: Annotated[Ints, Array("int32", FRAME)]
    """These frames, counted from 0 among those of the first tree."""
    visible: Annotated[Bools, Array("bool", FRAME, RING)]
    """Whether the frame shows the ring's part; where it does not, the other values are 0 or the identity."""
    one: Annotated[Floats, Array("float64", FRAME, RING, unit="length²")]
    """Mean squared distance from the surface as one piece."""
    two: Annotated[Floats, Array("float64", FRAME, RING, unit="length²")]
    """The same with the hinge."""
    rotation: Annotated[Floats, Array("float64", FRAME, RING, ROW, XYZ)]
    """Of the piece nearer to the body from the reference mesh to the frame's surface, with the hinge."""
    translation: Annotated[Floats, Array("float64", FRAME, RING, XYZ, unit="length")]
    """x(t) = rotation · v + translation for a vertex v of the nearer piece."""
    turn: Annotated[Floats, Array("float64", FRAME, RING, ROW, XYZ)]
    """Of the piece beyond the ring about its middle, before the nearer one is moved."""
