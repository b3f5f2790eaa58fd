"""How the meshes of successive intervals lie on each other at the cut between them (2014, Sec. 6.1.1.2 to 6.1.1.4)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import INTERVAL, PAIR, VERTEX


class CutCorrespondence(Artifact):
    """For every vertex of each interval's reference the vertex of the next one's and of the one before; the leaves too.

    The vertices of all references stand one after another: interval i's are `rows(i)`, its first is `first[i]`. What is
    one place is seen at the cut: interval i's reference as aligned to its last frame, and interval i + 1's as aligned to
    its first, are nearly in one pose. A label of interval i comes to interval i + 1 through the vertices of i + 1, each
    of which asks where it was: `backward` (the paper's v_j' ∈ V(t_begin), Eq. 8), and back through `onward`.
    """

    first: Annotated[Ints, Array("int32", INTERVAL)]
    """Where each interval's vertices begin."""
    leaves: Annotated[Ints, Array("int32", INTERVAL)]
    """How many leaves each interval has."""
    onward: Annotated[Ints, Array("int32", VERTEX)]
    """The nearest vertex of the next interval's reference, counted in that; −1 if its normal disagrees, and in the last."""
    onward_distance: Annotated[Floats, Array("float64", VERTEX, unit="length", finite=False)]
    """How far it is at the cut; NaN in the last interval."""
    backward: Annotated[Ints, Array("int32", VERTEX)]
    """The nearest vertex of the reference of the interval before, counted in that; −1 as for `onward`, and in the first."""
    backward_distance: Annotated[Floats, Array("float64", VERTEX, unit="length", finite=False)]
    """How far it is at the cut; NaN in the first interval."""
    cut: Annotated[Ints, Array("int32", PAIR)]
    """The interval before the cut, of each pair of leaves that are mutually nearest across it and whose normals agree."""
    before: Annotated[Ints, Array("int32", PAIR)]
    """The leaf before the cut: row of that interval's `Middle.leaf`."""
    behind: Annotated[Ints, Array("int32", PAIR)]
    """The leaf behind the cut: row of the next interval's `Middle.leaf`."""
    moved: Annotated[Floats, Array("float64", PAIR, unit="length")]
    """How far apart they are: |v(t_end) − v(t_begin)|, which Eq. 7 holds against a threshold."""

    handles: tuple[int, ...] = ()
    """Genus of each interval's reference."""

    def rows(self, interval: int) -> slice:
        """The rows of an interval's vertices."""
        last = interval + 1 == len(self.first)
        return slice(int(self.first[interval]), len(self.onward) if last else int(self.first[interval + 1]))

    def surplus(self, interval: int, *, ahead: bool) -> list[int]:
        """Leaves of an interval, rows of its `Middle.leaf`, without a partner across the cut ahead of it or behind it."""
        mine = self.before[self.cut == interval] if ahead else self.behind[self.cut == interval - 1]
        return sorted(set(range(int(self.leaves[interval]))) - set(mine.tolist()))
