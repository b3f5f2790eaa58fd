"""The reference mesh of one interval, its leaves, and the order in which the interval's frames are reached (2014, Sec. 5.3)."""

from typing import Annotated

import numpy as np

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import CORNER, FACE, FRAME, LEAF, VERTEX, XYZ


class IntervalReference(Artifact):
    """The mesh at the middle of an interval: it is aligned to the interval's frames, and cones are defined on it."""

    frames: tuple[int, ...]
    """Source frame numbers of the interval, ascending."""
    frame: int
    """Source frame number of the reference."""
    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """The reference's vertices, as its cleaned mesh has them."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Its faces."""
    area: Annotated[Floats, Array("float64", VERTEX, unit="length²")]
    """Area around each vertex; 0 outside the largest component, which does not count."""
    size: float
    """Root of the area, length."""
    leaf: Annotated[Ints, Array("int32", LEAF)]
    """The interval's fixed set of leaves: rows of `Leaves`, ascending; if tracked in one interval, the frame's extrema."""
    leaf_vertex: Annotated[Ints, Array("int32", LEAF)]
    """The reference's vertex at each leaf; −1 for a leaf that is not seen in the reference's frame."""
    coordinates: Annotated[Floats, Array("float64", LEAF, VERTEX, unit="length", finite=False)]
    """Geodesic coordinates of the reference: g(v, leaf); NaN outside the largest component and for a leaf not seen."""
    extremum: Annotated[Ints, Array("int32", LEAF, FRAME)]
    """Which of the frame's extrema each leaf is, in every frame of the interval; −1 where it is not seen or, if tracked, not
    needed: there a leaf is a vertex."""
    tracked: bool
    """Whether the sequence has fixed connectivity (Sec. 7): every vertex is its own image in all frames."""

    @property
    def genus(self) -> int:
        """Genus of the mesh where it is one closed surface, V − E + F = 2 − 2g; 0 where it is not."""
        F = np.asarray(self.faces)
        sides = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
        edges, uses = np.unique(sides, axis=0, return_counts=True)
        return 0 if (uses != 2).any() else (2 - len(np.unique(F)) + len(edges) - len(F)) // 2

    def previous(self, member: int) -> int | None:
        """The neighbour of a frame towards the reference; None for the reference."""
        at, start = self.frames.index(member), self.frames.index(self.frame)
        return None if at == start else self.frames[at - 1 if at > start else at + 1]
