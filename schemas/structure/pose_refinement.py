"""The finished body fitted to the surface of frames in which its pose is uncertain (2014, Sec. 7.3)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Floats
from kinetree.schemas.dims import FRAME, JOINT, ROW, XYZ


class PoseRefinement(Artifact):
    """Poses of one run of frames, each as before unless the fit covers the frame's surface better by a margin."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    moved: Annotated[Bools, Array("bool", FRAME)]
    """Whether the fit was accepted; where not, the pose is as before."""
    positions: Annotated[Floats, Array("float64", FRAME, JOINT, XYZ, unit="length")]
    """Of every joint in every frame."""
    rotation: Annotated[Floats, Array("float64", FRAME, JOINT, ROW, XYZ)]
    """From the reference pose to each frame, of the part that turns about the joint; a leaf has its parent's."""
    confidence: Annotated[Floats, Array("float64", FRAME, JOINT)]
    """How certain a joint's position in a frame is, 0 to 1."""
    before: Annotated[Floats, Array("float64", FRAME)]
    """Share of each frame's surface that the body leaves uncovered in the pose before."""
    after: Annotated[Floats, Array("float64", FRAME)]
    """The same after the fit; equal where it was not accepted."""
