"""The input meshes with their parts as PLY files, one a frame."""

from kinetree.schemas.results.exports import Exported


class Ply(Exported):
    """The input mesh of one frame; every vertex has the colour and the number of its part; the header names the parts."""
