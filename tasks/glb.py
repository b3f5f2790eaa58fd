"""The body as animators take it."""

from kinetree.pipeline.task import task
from kinetree.schemas.glb import ASSUMED_FPS, Glb, GlbParams
from kinetree.schemas.skeleton import Skeleton
from kinetree.tasks.exports.gltf import gltf


@task()
def glb(skeleton: Skeleton, params: GlbParams) -> Glb:
    """Writes skeleton.glb, the reference mesh skinned to the animated skeleton."""
    assumed = ASSUMED_FPS if skeleton.fps is None else None
    return Glb.of({"skeleton.glb": gltf(skeleton, params)}, assumed_fps=assumed)
