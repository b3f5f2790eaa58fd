"""Exports the joints as TRC, for OpenSim."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.trc import Trc, TrcParams
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.placement import in_unit, renamed
from kinetree.tasks.results.formats.takes import of_takes
from kinetree.tasks.results.formats.trc import trc as trc_text


@task(on_request=True)
def trc(skeleton: CompleteSkeleton, joint_names: JointNames, up_direction: UpDirection, params: TrcParams) -> Trc:
    """Writes skeleton.trc, every joint as a marker, upright and in millimetres (ours)."""
    body, known = in_unit(renamed(skeleton, joint_names), up_direction, params.up, params.scale, "mm")
    files = {f"skeleton{name}.trc": trc_text(own).encode() for name, own in of_takes(body).items()}
    return Trc.of(files, **known._asdict())
