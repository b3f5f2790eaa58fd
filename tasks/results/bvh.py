"""Exports the motion as BVH, for motion-capture programs."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.bvh import Bvh
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.bvh import bvh as bvh_text


@task()
def bvh(skeleton: Skeleton) -> Bvh:
    """Writes skeleton.bvh, the motion with constant bone lengths (ours)."""
    text, between = bvh_text(skeleton)
    return Bvh.of({"skeleton.bvh": text.encode()}, between=between)
