"""Exports the motion as BVH, for motion-capture programs."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.bvh import Bvh, BvhParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.placement import upright_rotation
from kinetree.tasks.numerics.results.units import METRES
from kinetree.tasks.results.formats.bvh import bvh as bvh_text
from kinetree.tasks.results.formats.placement import placed, placement


@task()
def bvh(skeleton: Skeleton, up_direction: UpDirection, params: BvhParams) -> Bvh:
    """Writes skeleton.bvh, the motion with constant bone lengths, upright and in centimetres (ours)."""
    known = placement(skeleton, up_direction, metres=params.scale and params.scale * METRES["cm"])
    scale = params.scale or known.metres / METRES["cm"]
    text, between = bvh_text(placed(skeleton, upright_rotation(known.up, params.up), scale))
    return Bvh.of({"skeleton.bvh": text.encode()}, between=between, **known._asdict())
