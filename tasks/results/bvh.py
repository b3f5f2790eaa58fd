"""The motion as motion-capture programs take it."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.bvh import Bvh
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.bvh import bvh as written


@task()
def bvh(skeleton: Skeleton) -> Bvh:
    """Writes skeleton.bvh, the motion with constant bone lengths (ours)."""
    text, between = written(skeleton)
    return Bvh.of({"skeleton.bvh": text.encode()}, between=between)
