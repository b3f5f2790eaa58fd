"""The articulated body with its final poses in all frames: of the aligned vertices, or of the fit to the surface.

Frames that the body was learned from have theirs with the tree; further frames were posed by themselves.
"""

from typing import Any

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.structure.further_pose import FurtherPose
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.pose_refinement import PoseRefinement
from kinetree.schemas.structure.skeleton import ArticulatedBody, Skeleton
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.structure.joint_rotations import joint_degrees


@task()
def skeleton(
    kinematic_tree: KinematicTree,
    pose_refinement: tuple[PoseRefinement, ...],
    further_pose: tuple[FurtherPose, ...],
    sequence: Sequence,
) -> Skeleton:
    """Puts the refined poses in their frames, and further frames among them; bones have one length in all (2014, Sec. 6.3)."""
    fields = {name: getattr(kinematic_tree, name) for name in ArticulatedBody.model_fields}
    if any(run.moved.any() for run in pose_refinement):
        for name in ("positions", "rotation", "confidence"):
            fields[name] = _replaced(fields[name], kinematic_tree.frames, pose_refinement, name)
    if further_pose:
        fields |= _with_further(fields, further_pose)
    if further_pose or any(run.moved.any() for run in pose_refinement):
        turns = np.array([kind == "joint" for kind in kinematic_tree.kinds])
        fields["degrees"] = joint_degrees(
            fields["rotation"], np.array(kinematic_tree.parents), turns, take_spans(fields["frames"])
        )
    return Skeleton(fps=sequence.fps, unit=sequence.unit, **fields)


def _with_further(fields: dict[str, Any], further: tuple[FurtherPose, ...]) -> dict[str, Any]:
    """The fields that depend on frames, with those of further frames in their places."""
    frames = (*fields["frames"], *(pose.frame for pose in further))
    order = np.argsort(frames)
    merged = {
        name: np.concatenate([fields[name], np.stack([getattr(pose, name) for pose in further])])[order]
        for name in ("positions", "rotation", "confidence")
    }
    support = fields["support"] + np.sum([pose.seen for pose in further], axis=0)
    return {"frames": tuple(frames[t] for t in order), "support": support, **merged}


def _replaced(before: Floats, frames: tuple[int, ...], runs: tuple[PoseRefinement, ...], name: str) -> Floats:
    """One array of all frames with the rows of the refined frames replaced."""
    after = np.array(before)
    for run in runs:
        after[[frames.index(frame) for frame in run.frames]] = getattr(run, name)
    return after
