"""The tree and the joints that a cut of the body in another of its poses gives (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Floats
from kinetree.schemas.dims import BARE_JOINT, BONE, FRAME, XYZ
from kinetree.schemas.structure.first_tree import JointTree


class FurtherCut(JointTree):
    """The tree of the rigid parts that the surface has as it lies in another frame; the frames need not show its joints."""

    frame: int
    """Source frame number of that pose."""
    bare_joints: Annotated[Floats, Array("float64", FRAME, BARE_JOINT, XYZ, unit="length")]
    """Its joints in every frame, but for its root and for the bones that no cut can find."""
    joints_with_bones: Annotated[Floats, Array("float64", FRAME, BONE, XYZ, unit="length")]
    """The same with such bones, where these are looked for; else the same joints."""
