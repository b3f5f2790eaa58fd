"""Every frame fitted again, by itself, with a learned stiffness, pass after pass (ours)."""

from kinetree.schemas.registration.pose import Pose


class Refit(Pose):
    """The pose of one frame after one pass; that of the last pass is final."""
