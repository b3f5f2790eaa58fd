"""The finished body posed in a frame that it was not learned from."""

from collections.abc import Mapping
from functools import cache

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.further_pose import FurtherPose
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure import further_pose as numerics
from kinetree.tasks.numerics.structure.articulated_frame import SkinnedBody, joints, joints_of_parts, parts_of_joints
from kinetree.tasks.numerics.structure.given_correspondence import is_given, limited_confidence
from kinetree.tasks.numerics.structure.pose_refinement import KnownPoses, needs_refinement, refined_pose
from kinetree.tasks.structure.pose_refinement import SAMPLE


@task(over="further")
def further_pose(kinematic_tree: KinematicTree, mesh: Mapping[int, Mesh], alignment: Mapping[int, Alignment]) -> FurtherPose:
    """Poses the body in one frame that nothing is learned from, as certain as its surface shows it (2014, Sec. 7.3; ours)."""
    tree = kinematic_tree
    ((frame, here), (aligned,)) = next(iter(mesh.items())), alignment.values()
    moving, part = parts_of_joints(tree.parents, tree.kinds)
    body = SkinnedBody.of_joints(
        tree.vertices, tree.faces, tree.influence, tree.weight, tree.rest, np.array(tree.parents), moving
    )
    x, confidence = np.array(aligned.vertices), np.array(aligned.confidence)
    known = KnownPoses(tree.rotation[:, moving], tree.confidence[:, moving])
    distance = np.abs(np.array(tree.frames) - frame)
    surface = cache(lambda: Target.of(np.array(here.vertices), here.faces, body.size, SAMPLE))
    ends = part[list(tree.end_joints)].tolist()
    found = numerics.further_pose(body, x, limited_confidence(confidence), known, distance, ends, surface)
    pose, sure, moved = found.pose, found.confidence, False
    if not is_given(confidence, np.array(aligned.residual)) and needs_refinement(sure):
        among = KnownPoses(np.concatenate([known.R, pose.R[None]]), np.concatenate([known.confidence, sure[None]]))
        fit = refined_pose(body, pose, surface(), x, confidence, among, len(known.R))
        pose, sure, moved = fit.pose, fit.confidence, fit.moved
    return FurtherPose(
        frame=frame,
        moved=moved,
        positions=joints_of_parts(tree.rest, tree.parents, tree.kinds, part, pose.R, joints(body, pose)),
        rotation=pose.R[part],
        confidence=sure[part],
        seen=found.seen[part],
    )
