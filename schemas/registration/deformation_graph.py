"""The reference mesh as a deformation graph: what every frame is fitted with (for 2014, Sec. 5.2)."""

from collections.abc import Sequence
from typing import Annotated, ClassVar

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Index, Ints, Params
from kinetree.schemas.dims import (
    BLOCK,
    CORNER,
    EDGE,
    END,
    FACE,
    INFLUENCE,
    LEAF,
    NEIGHBOUR,
    NODE,
    PAIRING,
    SAMPLE,
    STATION,
    VERTEX,
    XYZ,
)


class DeformationGraphParams(Params):
    """How finely the reference is covered with nodes, and how often all frames are fitted again."""

    nodes: int = Field(default=900, ge=10, le=100_000)
    """Nodes, at most one for every two vertices."""
    finest: float = Field(default=0.4, gt=0, le=1)
    """Spacing of nodes where the body is thinnest, share of the spacing where it is thick."""
    thick: float = Field(default=0.08, gt=0)
    """Thickness from which on the spacing no longer grows, share of the root of the area."""
    strut: float = Field(default=0.15, ge=0)
    """Edges link nodes on opposite sides, through the body, up to this thickness, share of the root of the area."""
    samples: int = Field(default=8, ge=1)
    """Vertices per node that stand for the surface in a fit."""
    passes: int = Field(default=3, ge=1, le=20)
    """Refits of all frames after tracking, each with the stiffness that the one before taught; the third repeats."""


class DeformationGraph(Artifact):
    """The rest shape and its graph, and in how many passes it is fitted to all frames.

    With fixed connectivity there is nothing to fit: the graph is empty and has no passes.
    """

    opens: ClassVar[tuple[str, ...]] = ("pass", "pass/search")
    orders: ClassVar[str] = "pass"
    frame: int
    """Source frame number of the reference, which every fit leaves as it is."""
    passes: int
    """How many times all frames are fitted again with a learned stiffness."""
    searched: tuple[int, ...] = ()
    """Passes before which limbs that lost their roll are searched for."""
    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Position of every vertex at rest."""
    faces: Annotated[Ints, Array("int32", FACE, CORNER)]
    """Faces of the reference mesh."""
    normals: Annotated[Floats, Array("float64", VERTEX, XYZ)]
    """Outward unit normals, smoothed."""
    nodes: Annotated[Ints, Array("int32", NODE)]
    """The vertex each node lies on, ascending."""
    bound: Annotated[Ints, Array("int32", VERTEX, INFLUENCE)]
    """The nodes each vertex follows, ascending along each row."""
    weight: Annotated[Floats, Array("float64", VERTEX, INFLUENCE)]
    """How far it follows each, not negative, summing to 1."""
    edges: Annotated[Ints, Array("int32", EDGE, END)]
    """Pairs of nodes that an edge links, the smaller first."""
    samples: Annotated[Ints, Array("int32", SAMPLE)]
    """Vertices that stand for the surface in a fit, ascending."""
    size: float
    """Root of the area, length."""
    stems: Annotated[Floats, Array("float64", LEAF, STATION, XYZ, unit="length")]
    """Points along the limbs at rest, from root to tip; none where there is nothing to fit."""
    degree: Annotated[Ints, Array("int32", VERTEX)]
    """Neighbours of every vertex over edges."""
    ring: Annotated[Ints, Array("int32", NEIGHBOUR)]
    """They themselves, vertex by vertex."""
    blocks: Annotated[Ints, Array("int32", BLOCK, END)]
    """Pairs of nodes that a fit couples."""
    block_of_vertex: Annotated[Ints, Array("int32", VERTEX, PAIRING)]
    """The block of every pair of nodes a vertex follows."""
    block_of_edge: Annotated[Ints, Array("int32", EDGE)]
    """The block of every edge."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The passes, numbered from 0; the one search of a pass, if it has one."""
        return range(self.passes) if space == "pass" else range(int(index[0] in self.searched))

    def previous(self, member: int) -> int | None:
        """The pass before; None for the first."""
        return member - 1 if member else None
