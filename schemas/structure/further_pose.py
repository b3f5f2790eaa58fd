"""The pose of the finished body in a frame that it was not learned from (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Floats
from kinetree.schemas.dims import JOINT, ROW, XYZ


class FurtherPose(Artifact):
    """Where the joints are in one further frame; of the aligned vertices, or of the fit to the surface where it was better."""

    frame: int
    """Source frame number."""
    moved: bool
    """Whether a fit to the surface was accepted."""
    positions: Annotated[Floats, Array("float64", JOINT, XYZ, unit="length")]
    """Of every joint."""
    rotation: Annotated[Floats, Array("float64", JOINT, ROW, XYZ)]
    """From the reference pose, of the part that turns about the joint; a leaf has its parent's."""
    confidence: Annotated[Floats, Array("float64", JOINT)]
    """How certain a joint's position is, 0 to 1."""
    seen: Annotated[Bools, Array("bool", JOINT)]
    """Whether most of the surface of the joint's parts was seen and certain."""
