"""The whole surface as rigid and non-rigid areas of kinematic cones and cylinders (2014, Sec. 6.2)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Ints
from kinetree.schemas.dims import AREA, VERTEX


class Cylinders(Artifact):
    """A partition of the model mesh into rigid and non-rigid areas.

    The model mesh is the reference of one interval: of those that see the most cones the one with the most frames. It becomes
    the mesh of the skeleton.
    """

    interval: int
    """The interval whose reference is the model mesh."""
    cones: int
    """How many cones there are; cylinders are numbered after them in the order in which they were found."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """The area of every vertex."""
    annulus: Annotated[Ints, Array("int32", VERTEX)]
    """Its annulus in its cone or cylinder, −1 for a vertex in neither, which has the area beside it."""
    rigid: Annotated[Bools, Array("bool", AREA)]
    """Whether an area is rigid; the others are joints."""
    cylinder: Annotated[Ints, Array("int32", AREA)]
    """The cone or cylinder that each area belongs to."""
    first_annulus: Annotated[Ints, Array("int32", AREA)]
    """Its first annulus there."""
    last_annulus: Annotated[Ints, Array("int32", AREA)]
    """Its last annulus there."""
