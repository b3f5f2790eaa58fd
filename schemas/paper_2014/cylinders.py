"""The whole surface as rigid and non-rigid areas of kinematic cones and cylinders (2014, Sec. 6.2)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Ints
from kinetree.schemas.dims import AREA, VERTEX


class Cylinders(Artifact):
    """A partition of one interval's reference: the interval that shows the most cones, and of these the longest."""

    interval: int
    """The interval on whose reference the areas are."""
    cones: int
    """How many of the pieces are cones, one for each limb; cylinders follow in the order in which they were found."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """The area of every vertex."""
    annulus: Annotated[Ints, Array("int32", VERTEX)]
    """Its annulus in its cone or cylinder, −1 for what was left to the areas around it."""
    rigid: Annotated[Bools, Array("bool", AREA)]
    """Whether an area is rigid; the others are joints."""
    piece: Annotated[Ints, Array("int32", AREA)]
    """The cone or cylinder that each area is of."""
    first: Annotated[Ints, Array("int32", AREA)]
    """Its first annulus there."""
    last: Annotated[Ints, Array("int32", AREA)]
    """Its last."""
