"""The agreed tree with the joints that the frames' surfaces alone show, at ends of limbs and within the trunk (ours)."""

from collections.abc import Sequence
from typing import Annotated, ClassVar

from kinetree.schemas.array import Array, Floats, Index, Params
from kinetree.schemas.dims import END_VERTEX, FRAME, XYZ
from kinetree.schemas.structure.first_tree import JointTree

LAID_TOGETHER = 2
"""Frames on which one task lays parts, at most."""


class ExtendedTreeParams(Params):
    """Where joints are placed."""

    surface_joints: bool = True
    """Whether joints are moved to where the frames' surfaces have them: all of the way if halves of the frames agree, else a
    part of it."""


class ExtendedTree(JointTree):
    """The agreed tree with joints at ends of limbs and within the trunk; those at ends come after all others."""

    opens: ClassVar[tuple[str, ...]] = ("laid", "laid/frame")
    cut_frame: int | None = None
    """As AgreedTree has it."""
    laid: tuple[int, ...] = ()
    """Source frames on whose surfaces parts are laid by themselves; a few of them are a member of "laid"."""
    shown: tuple[int, ...] = ()
    """Joints that the frames' surfaces alone show, ascending."""
    end_positions: Annotated[Floats, Array("float64", FRAME, END_VERTEX, XYZ, unit="length")]
    """Where the frames have the vertices on either side of the joints that their surfaces alone show, by number."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The runs of frames that parts are laid on, numbered from 0, or the source frames of one."""
        runs = [self.laid[k : k + LAID_TOGETHER] for k in range(0, len(self.laid), LAID_TOGETHER)]
        return range(len(runs)) if space == "laid" else runs[index[0]]
