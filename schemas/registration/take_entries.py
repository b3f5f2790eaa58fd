"""Where takes other than the reference's are entered (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import ROW, TAKE, XYZ


class TakeEntries(Artifact):
    """For every take but the reference's the frame that is reached first, and from which frame; none for one take alone."""

    frames: tuple[int, ...]
    """Source frame number of the entry of each take, in the order in which takes are reached."""
    before: tuple[int, ...]
    """Source frame number of the frame, of a take reached earlier, whose pose is nearest to it."""
    rotation: Annotated[Floats, Array("float64", TAKE, ROW, XYZ)]
    """Of the whole body, from that frame to the entry."""
    shift: Annotated[Floats, Array("float64", TAKE, XYZ, unit="length")]
    """x in the entry = rotation · x + shift for a point x of that frame."""
    distance: Annotated[Floats, Array("float64", TAKE)]
    """Mean distance between points on their limbs, share of the root of the area."""
