"""Exports the animated body as GLB, for animators."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.appearance import Appearance
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.glb import Glb, GlbParams
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.placement import upright_rotation
from kinetree.tasks.results.formats.assumed import NOTHING_ASSUMED, with_assumed
from kinetree.tasks.results.formats.gltf import gltf
from kinetree.tasks.results.formats.placement import known_front, placed, placement, renamed
from kinetree.tasks.results.formats.rest_pose import at_rest
from kinetree.tasks.results.formats.takes import of_takes

NO_APPEARANCE = Appearance.none()


@task()
def glb(
    skeleton: CompleteSkeleton,
    joint_names: JointNames,
    up_direction: UpDirection,
    params: GlbParams,
    appearance: Appearance = NO_APPEARANCE,
    assumed_joints: AssumedJoints = NOTHING_ASSUMED,
) -> Glb:
    """Writes skeleton.glb, the reference mesh skinned to the animated skeleton, upright and in metres (ours)."""
    known = placement(skeleton, up_direction, params.up, params.scale)
    rig = with_assumed(skeleton, joint_names, assumed_joints)
    named, rest = at_rest(renamed(rig.skeleton, rig.names), rig.names, known.up, params.rest)
    body = placed(named, upright_rotation(known.up, front=known_front(joint_names)), known.metres)
    origin = {"input_unit": skeleton.unit, "input_up": known.up, "metres_of_input_unit": known.metres}
    exported = appearance if params.surface == "input" else NO_APPEARANCE
    files = {f"skeleton{name}.glb": gltf(own, origin, exported) for name, own in of_takes(body).items()}
    return Glb.of(files, rest=rest, missing=exported.missing, **known._asdict())
