"""The animated body with a script that makes FBX of it in Blender."""

from kinetree.schemas.results.exports import Exported


class Blender(Exported):
    """skeleton.glb, and to_fbx.py for Blender, which writes skeleton.fbx and skeleton.blend beside it."""
