"""The truth of this sequence: its frames numbered as the sequence's, that of a generated body computed (ours)."""

import collections.abc as abc
from typing import ClassVar

from kinetree.schemas.array import Index
from kinetree.schemas.results.truth import TrueBody


class KnownTruth(TrueBody):
    """What the result is compared with; each frame that sequence and truth both have is a member of "true"."""

    opens: ClassVar[tuple[str, ...]] = ("true", "true/frame")
    compared: tuple[int, ...] = ()
    """Source frame numbers that both have, ascending; none where there is no truth."""

    def members(self, space: str, index: Index) -> abc.Sequence[int]:
        """The frames that are compared; each holds itself."""
        return self.compared if space == "true" else index
