"""Exports the animated body as GLB, for animators."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.glb import Glb, GlbParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.placement import upright_rotation
from kinetree.tasks.results.formats.gltf import gltf
from kinetree.tasks.results.formats.placement import placed, placement
from kinetree.tasks.results.formats.takes import of_takes


@task()
def glb(skeleton: CompleteSkeleton, up_direction: UpDirection, params: GlbParams) -> Glb:
    """Writes skeleton.glb, the reference mesh skinned to the animated skeleton, upright and in metres (ours)."""
    known = placement(skeleton, up_direction, params.up, params.scale)
    body = placed(skeleton, upright_rotation(known.up), known.metres)
    origin = {"input_unit": skeleton.unit, "input_up": known.up, "metres_of_input_unit": known.metres}
    return Glb.of({f"skeleton{name}.glb": gltf(own, origin) for name, own in of_takes(body).items()}, **known._asdict())
