"""Limbs fitted as rigid bodies from several rolls about their own axis, in one frame and pass (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import CANDIDATE, LIMB, ROW, XYZ


class RollCandidates(Artifact):
    """The fit of every limb from each start; the first start is where the limb is."""

    angle: Annotated[Floats, Array("float64", LIMB, CANDIDATE, unit="radian")]
    """Roll of the limb about its axis from where it was."""
    misfit: Annotated[Floats, Array("float64", LIMB, CANDIDATE)]
    """0 if all of the limb lies on the frame's surface, 1 if nothing of it does."""
    rotation: Annotated[Floats, Array("float64", LIMB, CANDIDATE, ROW, XYZ)]
    """Of the limb, from the reference to this frame."""
    place: Annotated[Floats, Array("float64", LIMB, CANDIDATE, XYZ, unit="length")]
    """Where the middle of the limb is in this frame."""
