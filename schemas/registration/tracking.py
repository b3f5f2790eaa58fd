"""The reference bent onto one frame from its neighbour's pose (2014, Sec. 5.3)."""

from typing import Annotated

from kinetree.schemas.array import Array, Floats
from kinetree.schemas.dims import NODE, ROW, XYZ
from kinetree.schemas.registration.pose import Pose


class Tracking(Pose):
    """A frame of the chain outwards from the reference, with what the next frame needs to start from."""

    steps: int
    """Frames between the reference and this one, in the order in which frames are reached; 0 for the reference."""
    uncovered: float
    """Share of the frame's surface that the body does not explain."""
    usual: float
    """Smallest share that any frame between the reference and this one leaves uncovered: holes of a capture."""
    attempt: int
    """Which way of fitting was taken; 0 is the usual one."""
    earlier_rotation: Annotated[Floats, Array("float64", NODE, ROW, XYZ)]
    """R of the frame before in the chain, from which to predict the next."""
    earlier_translation: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """p of the frame before."""
