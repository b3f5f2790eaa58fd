"""Exports the animated body as USD, for film and simulation."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.usd import Usd, UsdParams
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.placement import upright_rotation
from kinetree.tasks.results.formats.assumed import NOTHING_ASSUMED, with_assumed
from kinetree.tasks.results.formats.placement import placed, placement, renamed
from kinetree.tasks.results.formats.takes import of_takes
from kinetree.tasks.results.formats.usd import usd as usd_text


@task(on_request=True)
def usd(
    skeleton: CompleteSkeleton,
    joint_names: JointNames,
    up_direction: UpDirection,
    params: UsdParams,
    assumed_joints: AssumedJoints = NOTHING_ASSUMED,
) -> Usd:
    """Writes skeleton.usda, the reference mesh skinned to the animated skeleton, in metres (ours)."""
    known = placement(skeleton, up_direction, params.up, params.scale)
    up = "z" if known.up == "z" else "y"
    rig = with_assumed(skeleton, joint_names, assumed_joints)
    body = placed(renamed(rig.skeleton, rig.names), upright_rotation(known.up, up), known.metres)
    files = {f"skeleton{name}.usda": usd_text(own, up) for name, own in of_takes(body).items()}
    return Usd.of(files, **known._asdict())
