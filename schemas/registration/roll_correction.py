"""The first refit with every limb in the turn that it has over the whole sequence (ours)."""

from kinetree.schemas.registration.pose import Pose


class RollCorrection(Pose):
    """With lost twists of limbs brought back; the first refit where nothing was lost."""
