"""Exports the animated body as GLB, for animators."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.glb import ASSUMED_FPS, Glb, GlbParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.units import METRES
from kinetree.tasks.results.formats.gltf import gltf


@task()
def glb(skeleton: Skeleton, params: GlbParams) -> Glb:
    """Writes skeleton.glb, the reference mesh skinned to the animated skeleton (ours)."""
    assumed = ASSUMED_FPS if skeleton.fps is None else None
    scale = params.scale or METRES.get(skeleton.unit or "", 1.0)
    known = "set by glb.scale" if params.scale else skeleton.unit if skeleton.unit in METRES else None
    return Glb.of({"skeleton.glb": gltf(skeleton, params.up, scale)}, assumed_fps=assumed, scale=scale, unit=known)
