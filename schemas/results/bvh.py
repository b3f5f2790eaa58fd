"""The motion as motion-capture programs take it: a BVH file."""

from kinetree.schemas.results.exports import Exported


class Bvh(Exported):
    """skeleton.bvh: the joint tree with constant offsets, and its rotations in every frame."""

    between: int
    """Frames put in between where the sequence leaves some out: BVH has one frame time."""
