"""Settings as the parameters ship, for numerics that are called without their task: only parameters hold these defaults."""

from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.schemas.registration.tracking import TrackingParams
from kinetree.schemas.structure.kinematic_tree import KinematicTreeParams
from kinetree.schemas.structure.rigid_parts import RigidPartsParams
from kinetree.tasks.registration.deformation_graph import graph_settings
from kinetree.tasks.registration.pose import fit_settings
from kinetree.tasks.structure.arguments.frame_evidence import evidence_settings
from kinetree.tasks.structure.first_tree import tree_settings
from kinetree.tasks.structure.rigid_parts import parts_settings

GRAPH = graph_settings(DeformationGraphParams())
FITTING = fit_settings(TrackingParams())
PARTS = parts_settings(RigidPartsParams())
FIRST_CUT, ELIMINATION = PARTS.first_cut, PARTS.elimination
TREE = tree_settings(KinematicTreeParams())
PRUNING = TREE.pruning
EVIDENCE = evidence_settings(KinematicTreeParams())
