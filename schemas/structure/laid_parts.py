"""Parts of the body on the frames' own surfaces (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import BORDER_SHAPE, FRAME, FREEDOM, HINGE, HINGE_PLACE, OTHER_FREEDOM, PART, ROW, XYZ


class LaidParts(Artifact):
    """Parts laid on the surfaces of a few frames, by themselves, and in pairs with a hinge."""

    frame: Annotated[Ints, Array("int32", FRAME)]
    """These frames, counted from 0 among those of the extended tree."""
    joint: Annotated[Ints, Array("int32", PART)]
    """Joints of the extended tree about which the parts turn, ascending."""
    rotation: Annotated[Floats, Array("float64", FRAME, PART, ROW, XYZ)]
    """Of every part from the reference mesh to the frame's surface."""
    translation: Annotated[Floats, Array("float64", FRAME, PART, XYZ, unit="length")]
    """x(t) = rotation · v + translation for a vertex v of the reference mesh."""
    stiffness: Annotated[Floats, Array("float64", FRAME, PART, FREEDOM, OTHER_FREEDOM)]
    """How firmly the surface holds the part against a turn about its joint and a shift."""
    square: Annotated[Floats, Array("float64", FRAME, PART, unit="length²")]
    """Mean squared distance of the part from the surface."""
    hinge_joint: Annotated[Ints, Array("int32", HINGE)]
    """Joints of the extended tree whose two parts are laid with a hinge, ascending."""
    hinge_end: Annotated[Floats, Array("float64", HINGE, XYZ, unit="length")]
    """Where the bone beyond such a joint ends in the reference mesh, if no joint follows."""
    hinge_square: Annotated[Floats, Array("float64", FRAME, HINGE, BORDER_SHAPE, HINGE_PLACE, unit="length²")]
    """Mean squared distance of both parts from the surface, by shape of their border and place of the hinge along the limb."""
