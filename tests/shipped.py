"""Settings as the parameters ship, for numerics that are called without their task: only parameters hold these defaults."""

from kinetree.schemas.registration.tracking import TrackingParams
from kinetree.schemas.structure.kinematic_tree import KinematicTreeParams
from kinetree.tasks.numerics.structure.joint_evidence import JointEvidenceSettings
from kinetree.tasks.registration.pose import fit_settings

FITTING = fit_settings(TrackingParams())
_TREE = KinematicTreeParams()
EVIDENCE = JointEvidenceSettings(_TREE.clear_motion, _TREE.misfit_ratio, _TREE.misfit_ratio_if_moving)
