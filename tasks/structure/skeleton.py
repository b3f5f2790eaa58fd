"""The articulated body with its final poses: of the aligned vertices, or of the fit to the surface where it was better."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.pose_refinement import PoseRefinement
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.structure.joint_rotations import joint_degrees


@task()
def skeleton(kinematic_tree: KinematicTree, pose_refinement: tuple[PoseRefinement, ...]) -> Skeleton:
    """Puts the refined poses in their frames; bones have one length in all of them (2014, Sec. 6.3)."""
    fields = {name: getattr(kinematic_tree, name) for name in Skeleton.model_fields}
    if any(run.moved.any() for run in pose_refinement):
        for name in ("positions", "rotation", "confidence"):
            fields[name] = _replaced(fields[name], kinematic_tree.frames, pose_refinement, name)
        turns = np.array([kind == "joint" for kind in kinematic_tree.kinds])
        fields["degrees"] = joint_degrees(fields["rotation"], np.array(kinematic_tree.parents), turns)
    return Skeleton(**fields)


def _replaced(before: Floats, frames: tuple[int, ...], runs: tuple[PoseRefinement, ...], name: str) -> Floats:
    """One array of all frames with the rows of the refined frames replaced."""
    after = np.array(before)
    for run in runs:
        after[[frames.index(frame) for frame in run.frames]] = getattr(run, name)
    return after
