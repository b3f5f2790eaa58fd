"""The tree that the cuts agree on (ours)."""

from collections.abc import Sequence
from typing import ClassVar

from kinetree.schemas.array import Index
from kinetree.schemas.structure.first_tree import JointTree


class AgreedTree(JointTree):
    """The tree of the first cut or of another one, without joints that no other cut has and that it does not need."""

    opens: ClassVar[tuple[str, ...]] = ("judged", "judged/frame")
    judged: tuple[tuple[int, ...], ...] = ()
    """Source frames in which rings at ends of limbs and across the trunk are judged, in runs of a few that follow each other:
    each is a member of "judged". Empty where such joints are not looked for."""
    cut_frame: int | None = None
    """Source frame of the cut whose tree this is, if another than that in the reference."""
    is_given: bool = False
    """Whether the frames give the correspondence, so that their surfaces say nothing more."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The runs of frames in which rings are judged, numbered from 0, or the source frames of one."""
        return range(len(self.judged)) if space == "judged" else self.judged[index[0]]
