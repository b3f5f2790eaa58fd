"""The motion as a BVH file, for motion-capture programs."""

from kinetree.schemas.results.exports import Exported


class Bvh(Exported):
    """skeleton.bvh: the joint tree with constant offsets, and its rotations in every frame."""

    between: int
    """Number of interpolated frames: BVH has one frame time, so missing frames are interpolated."""
