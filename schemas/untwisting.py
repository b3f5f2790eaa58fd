"""The first refit with every limb in the turn that it has over the whole sequence (ours)."""

from kinetree.schemas.pose import Pose


class Untwisting(Pose):
    """With lost twists of limbs brought back; the first refit where nothing was lost."""
