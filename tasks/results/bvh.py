"""Exports the motion as BVH, for motion-capture programs."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.bvh import Bvh, BvhParams
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.bvh import bvh as bvh_text
from kinetree.tasks.results.formats.placement import in_unit


@task()
def bvh(skeleton: CompleteSkeleton, up_direction: UpDirection, params: BvhParams) -> Bvh:
    """Writes skeleton.bvh, the motion with constant bone lengths, upright and in centimetres (ours)."""
    body, known = in_unit(skeleton, up_direction, params.up, params.scale, "cm")
    text, between = bvh_text(body)
    return Bvh.of({"skeleton.bvh": text.encode()}, between=between, **known._asdict())
