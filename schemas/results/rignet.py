"""The rig in RigNet's text format, for learning programs."""

from kinetree.schemas.results.exports import Exported


class Rignet(Exported):
    """skeleton.txt with joints, hierarchy and skin, and skeleton.obj, the mesh to whose vertices it refers."""
