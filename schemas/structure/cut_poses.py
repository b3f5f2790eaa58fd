"""The poses in which the body is cut once more (ours)."""

from collections.abc import Sequence
from typing import ClassVar

from kinetree.schemas.array import Artifact, Index
from kinetree.schemas.structure.rigid_parts import CutParams


class CutPoses(Artifact):
    """Poses that differ most from the reference's and from one another's; each is a member of "cut"."""

    opens: ClassVar[tuple[str, ...]] = ("cut",)
    frames: tuple[int, ...] = ()
    """Source frame numbers of these poses, in the order in which they were chosen."""
    settings: CutParams = CutParams()
    """How the body is cut in all poses."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The frames of further cuts."""
        return sorted(self.frames)
