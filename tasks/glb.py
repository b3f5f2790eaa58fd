"""The body as animators take it."""

from kinetree.pipeline.task import task
from kinetree.schemas.glb import ASSUMED_FPS, Glb, GlbParams
from kinetree.schemas.skeleton import Skeleton
from kinetree.tasks.exports.gltf import gltf
from kinetree.tasks.exports.units import METRES


@task()
def glb(skeleton: Skeleton, params: GlbParams) -> Glb:
    """Writes skeleton.glb, the reference mesh skinned to the animated skeleton."""
    assumed = ASSUMED_FPS if skeleton.fps is None else None
    metres = METRES.get(skeleton.unit or "")
    life_size = metres if metres is not None and params.scale == 1.0 != metres else None
    return Glb.of({"skeleton.glb": gltf(skeleton, params)}, assumed_fps=assumed, life_size=life_size)
