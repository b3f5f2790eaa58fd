"""Every frame fitted by itself from its tracked pose (ours)."""

from kinetree.schemas.registration.pose import Pose
from kinetree.schemas.registration.tracking import TrackingParams


class FirstFit(Pose):
    """The pose of one frame before the first pass, and before failed frames are recovered."""

    uncovered: float
    """Share of the frame's surface that the body does not explain; 0 of the reference."""
    attempt: int
    """Which way of fitting was taken; 0 is the usual one."""
    fitting: TrackingParams = TrackingParams()
    """How the frame would be fitted from its neighbour's pose; a frame that is tracked again is fitted alike."""
