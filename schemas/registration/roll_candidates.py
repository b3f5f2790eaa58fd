"""Limbs tried in other turns about their own axis, in one frame (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import LIMB, ROW, TURN, XYZ


class RollCandidates(Artifact):
    """What every limb fits as a rigid body from several turns about its axis; the first begins where it is."""

    angle: Annotated[Floats, Array("float64", LIMB, TURN, unit="radian")]
    """How far the limb turned about its axis from where it was."""
    misfit: Annotated[Floats, Array("float64", LIMB, TURN)]
    """0 where all of the limb lies on the frame's surface, 1 where nothing of it does."""
    rotation: Annotated[Floats, Array("float64", LIMB, TURN, ROW, XYZ)]
    """Of the limb, from the reference to this frame."""
    place: Annotated[Floats, Array("float64", LIMB, TURN, XYZ, unit="length")]
    """Where the middle of the limb is in this frame."""
