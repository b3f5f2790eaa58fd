"""The joints that a cut of the body in another of its poses gives (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import BONE, FRAME, JOINT, XYZ


class FurtherCut(Artifact):
    """Joints between the rigid parts that the surface has as it lies in another frame."""

    frame: int
    """Source frame number of that pose."""
    joints: Annotated[Floats, Array("float64", FRAME, JOINT, XYZ, unit="length")]
    """Its joints in every frame, but for its root."""
    joints_with_bones: Annotated[Floats, Array("float64", FRAME, BONE, XYZ, unit="length")]
    """The same with the bones that no cut can find, where these are looked for; else the same joints."""
