"""The skeleton as programs take it."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.skeleton_json import SkeletonJson
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.document import written


@task()
def skeleton_json(skeleton: Skeleton) -> SkeletonJson:
    """Writes skeleton.json, the joint tree and every joint's position in every frame (ours)."""
    return SkeletonJson.of({"skeleton.json": written(skeleton)})
