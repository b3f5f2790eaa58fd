"""Step III, the mesoscopic view: rigid parts, their tree, poses (2014, Sec. 6 and 7.3)."""

from kinetree.tasks.structure.agreed_tree import agreed_tree
from kinetree.tasks.structure.cut_poses import cut_poses
from kinetree.tasks.structure.end_rings import end_rings
from kinetree.tasks.structure.error_bars import error_bars
from kinetree.tasks.structure.extended_tree import extended_tree
from kinetree.tasks.structure.first_tree import first_tree
from kinetree.tasks.structure.further_cut import further_cut
from kinetree.tasks.structure.further_pose import further_pose
from kinetree.tasks.structure.joint_names import joint_names
from kinetree.tasks.structure.kinematic_tree import kinematic_tree
from kinetree.tasks.structure.laid_parts import laid_parts
from kinetree.tasks.structure.pose_refinement import pose_refinement
from kinetree.tasks.structure.rigid_parts import rigid_parts
from kinetree.tasks.structure.skeleton import skeleton

STRUCTURE = (
    rigid_parts,
    cut_poses,
    further_cut,
    first_tree,
    agreed_tree,
    end_rings,
    extended_tree,
    laid_parts,
    kinematic_tree,
    pose_refinement,
    further_pose,
    skeleton,
    error_bars,
    joint_names,
)
