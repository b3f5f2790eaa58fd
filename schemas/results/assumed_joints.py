"""Joints that a recognised body has and that were not found, mostly since they never turned (ours)."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Artifact, Params


class AssumedJointsParams(Params):
    """Whether files and the page have them."""

    add: bool = False
    """Adds knees, elbows, ankles, wrists and a neck that were not found to files and the page; they are counted nowhere."""


class AssumedJoint(Params):
    """A joint on a bone that was found in one piece."""

    name: str
    """In files, unique among all joints."""
    anatomy: str
    """Station and side in kinetree's spelling, such as knee_l."""
    child: int = Field(ge=1)
    """The joint of the skeleton at the outer end of the bone."""
    share: float = Field(gt=0, lt=1)
    """Place along the bone: 0 at the inner end, 1 at the outer."""
    place: tuple[float, float, float]
    """In the reference pose, mesh unit: the middle of the limb there; on the straight bone where that cannot be told."""
    source: Literal["mirror", "proportions"]
    """mirror: the place is that of the same joint on the other side; proportions: that of published proportions of people."""


class AssumedJoints(Artifact):
    """Joints that files and the page offer, though nothing was measured of them."""

    joints: tuple[AssumedJoint, ...] = ()
    """Those of one bone from the inner end outwards; none where they are not wanted or the body is not recognised."""
