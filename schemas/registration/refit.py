"""Frames fitted again, each by itself, with a learned stiffness (ours)."""

from kinetree.schemas.registration.pose import Pose


class FirstRefit(Pose):
    """With what the tracked poses taught."""


class SecondRefit(Pose):
    """With what the first refit taught, from limbs that have their twist."""


class ThirdRefit(Pose):
    """With what the second refit taught: the final pose."""
