"""The body cut into rigid parts once more, in another of its poses."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import CutJointsParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure.cut_joints import cut_trees
from kinetree.tasks.numerics.structure.first_tree import in_reference, in_tree_order
from kinetree.tasks.numerics.structure.rigid_parts import rigid_parts
from kinetree.tasks.numerics.structure.tree_joints import Cut
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.joint_tree import fields_of
from kinetree.tasks.structure.first_tree import tree_settings
from kinetree.tasks.structure.rigid_parts import parts_settings


@task(over="cut", among=Sequence, block="kinematic_tree")
def further_cut(
    cut_poses: CutPoses,
    reference: Reference,
    alignment: Mapping[int, Alignment],
    leaves: Leaves,
    params: CutJointsParams,
    index: Index,
) -> FurtherCut:
    """Divides the surface as it lies in another frame, by the settings of `rigid_parts`, and joins its parts (ours)."""
    (frame,), body = index, aligned_body(reference, alignment, leaves)
    pose, (_, F, x, _, takes) = np.array(alignment[frame].vertices), body.surface
    cut_settings = parts_settings(cut_poses.settings)
    parts = rigid_parts(pose, F, x, body.confidence, body.tips, settings=cut_settings, takes=takes)
    cut = Cut(pose, np.asarray(parts.label, np.int64), np.array(parts.R), np.array(parts.t), np.array(parts.residual))
    settings = tree_settings(params)._replace(hidden_bones=params.hidden_bones and body.is_given)
    found = cut_trees(body.surface, cut, body.tips, body.confidence, settings)
    frames = tuple(alignment)
    tree = in_reference(in_tree_order(found.tree, cut.R.shape[1]), cut, frames.index(reference.frame))
    bare, with_bones = (joints.motion.carried(joints.rest[1:]) for joints in (found.bare, found.with_bones))
    return FurtherCut(frame=frame, frames=frames, bare_joints=bare, joints_with_bones=with_bones, **fields_of(tree))
