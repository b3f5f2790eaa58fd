"""The rig as learning programs take it: RigNet's text."""

from kinetree.schemas.results.exports import Exported


class Rignet(Exported):
    """skeleton.txt with joints, hierarchy and skin, and skeleton.obj, the mesh whose vertices it numbers."""
