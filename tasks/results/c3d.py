"""Exports the joints as C3D, for motion analysis."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.c3d import C3d, C3dParams
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.c3d import c3d as c3d_bytes
from kinetree.tasks.results.formats.placement import in_unit, renamed
from kinetree.tasks.results.formats.takes import of_takes


@task(on_request=True)
def c3d(skeleton: CompleteSkeleton, joint_names: JointNames, up_direction: UpDirection, params: C3dParams) -> C3d:
    """Writes skeleton.c3d, every joint as a marker, upright and in millimetres (ours)."""
    body, known = in_unit(renamed(skeleton, joint_names), up_direction, params.up, params.scale, "mm")
    files = {f"skeleton{name}.c3d": c3d_bytes(own, params.up) for name, own in of_takes(body).items()}
    return C3d.of(files, **known._asdict())
