"""One set of cones for the whole sequence: matched, freed of erroneous ones, recovered (2014, Sec. 6.1.1.2 to 6.1.1.4)."""

from collections.abc import Sequence
from typing import Annotated, ClassVar

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Index, Ints, Params
from kinetree.schemas.dims import CONE, INTERVAL, VERTEX


class ConeConsistencyParams(Params):
    """How far leaves may move."""

    leap: float = Field(default=0.3, gt=0)
    """θ of Eq. 7: how far a leaf may move between two frames, share of the root of the area; the paper gives no number."""


class ConeConsistency(Artifact):
    """The cones of every interval, numbered alike in all intervals; each interval has all of them."""

    opens: ClassVar[tuple[str, ...]] = ("interval/cone",)
    annuli: int
    """Annuli in the longest distance from each leaf."""
    first: Annotated[Ints, Array("int32", INTERVAL)]
    """First vertex of each interval; the vertices of all references stand one after another."""
    annulus: Annotated[Ints, Array("int32", CONE, VERTEX)]
    """Annulus of every vertex of every reference in each cone, −1 beyond it."""
    leaf: Annotated[Ints, Array("int32", INTERVAL, CONE)]
    """The leaf of each cone, a row of that interval's `IntervalReference.leaf`; −1 where the cone was recovered."""

    def rows(self, interval: int) -> slice:
        """The vertices of an interval's reference."""
        end = int(self.first[interval + 1]) if interval + 1 < len(self.first) else self.annulus.shape[1]
        return slice(int(self.first[interval]), end)

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The cones, numbered from 0, the same in all intervals."""
        return range(len(self.annulus))
