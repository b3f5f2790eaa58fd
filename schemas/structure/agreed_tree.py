"""The first tree without joints that no other cut has (ours)."""

from collections.abc import Sequence
from typing import ClassVar

from kinetree.schemas.array import Index
from kinetree.schemas.structure.first_tree import JointTree


class AgreedTree(JointTree):
    """The joints of the first cut that another cut has too, or that the others need."""

    opens: ClassVar[tuple[str, ...]] = ("judged", "judged/frame")
    judged: tuple[tuple[int, ...], ...] = ()
    """Source frames in which rings at ends of limbs are judged, in runs of a few that follow each other: each is a member of
    "judged". Empty where joints at ends are not looked for."""
    is_given: bool = False
    """Whether the frames give the correspondence, so that their surfaces say nothing more."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The runs of frames in which rings are judged, numbered from 0, or the source frames of one."""
        return range(len(self.judged)) if space == "judged" else self.judged[index[0]]
