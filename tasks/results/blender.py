"""Exports the animated body for Blender, which makes FBX of it."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.results.blender import Blender
from kinetree.schemas.results.glb import ASSUMED_FPS, Glb
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.blender import fbx_script


@task(on_request=True)
def blender(glb: Glb, skeleton: Skeleton) -> Blender:
    """Writes skeleton.glb with a script that turns it into FBX in Blender (ours)."""
    ends = np.cumsum(glb.sizes).tolist()
    content = glb.content.tobytes()
    models = {name: content[end - size : end] for name, size, end in zip(glb.names, glb.sizes, ends, strict=True)}
    script = fbx_script(skeleton.fps or ASSUMED_FPS)
    files = {f"blender/{name}": model for name, model in models.items()}
    return Blender.of(files | {"blender/to_fbx.py": script.encode()})
