"""Where takes other than the reference's are entered (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import ROW, START, XYZ


class TakeEntries(Artifact):
    """For every take but the reference's the frame that is reached first, and from which frame; none for one take alone."""

    frames: tuple[int, ...]
    """Source frame number of the entry of each take, in the order in which takes are reached."""
    before: tuple[int, ...]
    """Source frame number of the frame, of a take reached earlier, whose pose is nearest to it."""
    entry: Annotated[Ints, Array("int32", START)]
    """To which entry, by its number among `frames`, each motion below belongs. A body is much like itself back to front, and
    the surface decides between them."""
    rotation: Annotated[Floats, Array("float64", START, ROW, XYZ)]
    """Of the whole body, from that frame to the entry."""
    shift: Annotated[Floats, Array("float64", START, XYZ, unit="length")]
    """x in the entry = rotation · x + shift for a point x of that frame."""
    distance: Annotated[Floats, Array("float64", START)]
    """Mean distance between points on their limbs, share of the root of the area; least of an entry's first motion."""
