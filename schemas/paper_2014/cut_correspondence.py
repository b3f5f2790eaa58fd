"""Correspondences between the meshes of successive intervals at the cut between them (2014, Sec. 6.1.1.2 to 6.1.1.4)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import INTERVAL, PAIR, VERTEX

Maps = list[NDArray[np.int64]]


class CutCorrespondence(Artifact):
    """For every vertex of each interval's reference the vertex of the next one's and of the previous one's; and the leaves.

    The vertices of all references stand one after another: those of interval i are `rows(i)`. Correspondences are found at
    the cut, where interval i's reference aligned to its last frame and interval i + 1's aligned to its first frame are nearly
    in one pose. Eq. 8 transfers a label of interval i to the vertices v_j' of interval i + 1 by `to_previous`; the opposite
    direction is `to_next`.
    """

    first: Annotated[Ints, Array("int32", INTERVAL)]
    """First vertex of each interval."""
    leaf_count: Annotated[Ints, Array("int32", INTERVAL)]
    """Number of leaves of each interval."""
    to_next: Annotated[Ints, Array("int32", VERTEX)]
    """The nearest vertex of the next interval's reference, counted in that; −1 if its normal disagrees, and in the last."""
    to_next_distance: Annotated[Floats, Array("float64", VERTEX, unit="length", finite=False)]
    """Its distance at the cut; NaN in the last interval."""
    to_previous: Annotated[Ints, Array("int32", VERTEX)]
    """The nearest vertex of the previous interval's reference, counted in that; −1 as for `to_next`, and in the first."""
    to_previous_distance: Annotated[Floats, Array("float64", VERTEX, unit="length", finite=False)]
    """Its distance at the cut; NaN in the first interval."""
    cut: Annotated[Ints, Array("int32", PAIR)]
    """The interval before the cut, of each pair of leaves that are mutually nearest across it and whose normals agree."""
    leaf_before: Annotated[Ints, Array("int32", PAIR)]
    """The leaf before the cut: row of that interval's `IntervalReference.leaf`."""
    leaf_after: Annotated[Ints, Array("int32", PAIR)]
    """The leaf after the cut: row of the next interval's `IntervalReference.leaf`."""
    leaf_distance: Annotated[Floats, Array("float64", PAIR, unit="length")]
    """Distance between the two, |v(t_end) − v(t_begin)|, which Eq. 7 compares with a threshold."""
    genus: tuple[int, ...] = ()
    """Genus of each interval's reference."""

    def rows(self, interval: int) -> slice:
        """The rows of an interval's vertices."""
        last = interval + 1 == len(self.first)
        return slice(int(self.first[interval]), len(self.to_next) if last else int(self.first[interval + 1]))

    def maps(self) -> tuple[Maps, Maps]:
        """Of each cut, the map (vertex,) from the interval before it to the one after, and the reverse; −1 for none."""
        cuts = range(len(self.first) - 1)
        forwards = [self.to_next[self.rows(i)].astype(np.int64) for i in cuts]
        return forwards, [self.to_previous[self.rows(i + 1)].astype(np.int64) for i in cuts]

    def surplus(self, interval: int, *, at_end: bool) -> list[int]:
        """Leaves of an interval, rows of its `IntervalReference.leaf`, without a partner across the cut at its end or begin."""
        matched = self.leaf_before[self.cut == interval] if at_end else self.leaf_after[self.cut == interval - 1]
        return sorted(set(range(int(self.leaf_count[interval]))) - set(matched.tolist()))
