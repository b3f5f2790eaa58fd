"""Exports the motion as BVH, for motion-capture programs."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.bvh import Bvh, BvhParams
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.assumed import NOTHING_ASSUMED, with_assumed
from kinetree.tasks.results.formats.bvh import bvh as bvh_text
from kinetree.tasks.results.formats.placement import in_unit, known_front, renamed
from kinetree.tasks.results.formats.rest_pose import at_rest
from kinetree.tasks.results.formats.takes import of_takes


@task()
def bvh(
    skeleton: CompleteSkeleton,
    joint_names: JointNames,
    up_direction: UpDirection,
    params: BvhParams,
    assumed_joints: AssumedJoints = NOTHING_ASSUMED,
) -> Bvh:
    """Writes skeleton.bvh, the motion with constant bone lengths, upright and in centimetres (ours)."""
    rig = with_assumed(skeleton, joint_names, assumed_joints)
    named, rest = at_rest(renamed(rig.skeleton, rig.names), rig.names, up_direction.up, params.rest)
    body, known = in_unit(named, up_direction, params.up, params.scale, "cm", known_front(joint_names))
    texts = {name: bvh_text(own) for name, own in of_takes(body).items()}
    files = {f"skeleton{name}.bvh": text.encode() for name, (text, _) in texts.items()}
    return Bvh.of(files, rest=rest, between=sum(between for _, between in texts.values()), **known._asdict())
