"""Exports the skeleton as JSON, for programs."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.skeleton_json import SkeletonJson
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.assumed import NOTHING_ASSUMED, with_assumed
from kinetree.tasks.results.formats.document import skeleton_file
from kinetree.tasks.results.formats.takes import bars_of_takes, of_takes


@task()
def skeleton_json(
    skeleton: CompleteSkeleton,
    joint_names: JointNames,
    up_direction: UpDirection,
    error_bars: ErrorBars,
    assumed_joints: AssumedJoints = NOTHING_ASSUMED,
) -> SkeletonJson:
    """Writes skeleton.json, the joint tree with every joint's position and rotation in every frame (ours)."""
    rig = with_assumed(skeleton, joint_names, assumed_joints)
    bars = bars_of_takes(error_bars, skeleton)
    files = {
        f"skeleton{name}.json": skeleton_file(own, rig.names, up_direction, own.interpolated, rig.assumed, bars.get(name))
        for name, own in of_takes(rig.skeleton).items()
    }
    return SkeletonJson.of(files)
