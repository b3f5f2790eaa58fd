"""Exports the animated body for Blender, which makes FBX of it."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.blender import Blender
from kinetree.schemas.results.glb import ASSUMED_FPS, Glb
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.blender import fbx_script


@task(on_request=True)
def blender(glb: Glb, skeleton: Skeleton) -> Blender:
    """Writes skeleton.glb with a script that turns it into FBX in Blender (ours)."""
    script = fbx_script(skeleton.fps or ASSUMED_FPS)
    return Blender.of({"blender/skeleton.glb": glb.content.tobytes(), "blender/to_fbx.py": script.encode()})
