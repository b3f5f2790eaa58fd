"""The finished body fitted to the surface of frames in which its pose is uncertain (2014, Sec. 7.3)."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.pose_refinement import PoseRefinement
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure import pose_refinement as numerics
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody, joints, joints_of_parts, parts_of_joints

SAMPLE = 3000
"""Vertices that stand for a frame's surface; not recorded, for time."""


@task(over="doubt")
def pose_refinement(
    kinematic_tree: KinematicTree, mesh: Mapping[int, Mesh], alignment: Mapping[int, Alignment]
) -> PoseRefinement:
    """Fits the body to the surface of each uncertain frame, and keeps the fit where it is better (2014, Sec. 7.3)."""
    tree = kinematic_tree
    moving, part = parts_of_joints(tree.parents, tree.kinds)
    body = SkinnedBody.of_joints(
        tree.vertices, tree.faces, tree.influence, tree.weight, tree.rest, np.array(tree.parents), moving
    )
    known = numerics.KnownPoses(tree.rotation[:, moving], tree.confidence[:, moving])
    rows = [tree.frames.index(frame) for frame in mesh]
    poses = {name: np.array(getattr(tree, name)[rows]) for name in ("positions", "rotation", "confidence")}
    moved, share = np.zeros(len(rows), np.bool_), np.zeros((2, len(rows)))
    for k, (row, frame, aligned) in enumerate(zip(rows, mesh.values(), alignment.values(), strict=True)):
        start = FramePose(known.R[row].copy(), tree.positions[row, 0].copy())
        target = Target.of(np.array(frame.vertices), frame.faces, body.size, SAMPLE)
        fit = numerics.refined_pose(body, start, target, np.array(aligned.vertices), np.array(aligned.confidence), known, row)
        moved[k], share[:, k] = fit.moved, (fit.before, fit.after)
        if fit.moved:
            X = joints(body, fit.pose)
            poses["positions"][k] = joints_of_parts(tree.rest, tree.parents, tree.kinds, part, fit.pose.R, X)
            poses["rotation"][k], poses["confidence"][k] = fit.pose.R[part], fit.confidence[part]
    return PoseRefinement(frames=tuple(mesh), moved=moved, before=share[0], after=share[1], **poses)
