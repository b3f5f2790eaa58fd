"""The motion as motion-capture programs take it: a BVH file."""

from kinetree.schemas.results.exports import Exported


class Bvh(Exported):
    """skeleton.bvh: the joint tree with constant offsets, and its rotations in every frame."""

    between: int
    """Frames put in between where the sequence leaves some out: BVH has one frame time."""

    def remarks(self) -> tuple[str, ...]:
        """That frames were put in between, where they were."""
        told = f"the frames are not evenly spaced: {self.between} were put in between, as BVH has one frame time"
        return (told,) if self.between else ()
