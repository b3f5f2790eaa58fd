"""A suspect frame tried again from its other side (ours)."""

from kinetree.schemas.registration.pose import Pose


class Recovery(Pose):
    """The tracked pose, or a better one where the body had lost a limb."""

    uncovered: float
    """Share of the frame's surface that the body does not explain."""
    repaired: bool
    """Whether another pose than the tracked one was taken."""
