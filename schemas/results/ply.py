"""The user's own meshes with their parts: a PLY file a frame."""


from kinetree.schemas.results.exports import Exported


class Ply(Exported):
    """One frame's mesh as it was given, every vertex with the colour and the number of its part."""
