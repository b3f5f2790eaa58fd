"""The pseudo endoskeleton Reeb graph of one frame: inside the body, node by node and edge by edge (2009, Sec. 2.1)."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Params
from kinetree.schemas.dims import EDGE, END, LEAF, LOOP, NODE, VERTEX, XYZ

Longs = NDArray[np.int64]


class PergParams(Params):
    """With what the graph begins, and what is simplified."""

    start: int = Field(default=2, ge=0, le=10)
    """Resolution with which the replacement begins; 0 is the finest, each next one has half as many bands."""
    outside: Literal["moved", "kept"] = "moved"
    """What becomes of nodes and edges outside the body at the finest resolution; the paper has no rule for them."""
    least_loop: float = Field(default=0.05, ge=0, le=1)
    """Share of the range of μ that a loop must span; a shorter one is noise and is opened. Carved hulls have up to 0.02."""
    branches: Literal["leaves", "all"] = "leaves"
    """leaves: branches that do not end in a leaf are removed; all: every branch counts."""


class Perg(Artifact):
    """The graph of one frame."""

    node: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """Position of every node."""
    level: Annotated[Longs, Array("int64", NODE)]
    """Resolution that each node is from, 0 the finest; −1 for one at which an edge was bent."""
    height: Annotated[Floats, Array("float64", NODE)]
    """Middle of its bands, share of the range of μ."""
    area: Annotated[Floats, Array("float64", NODE, unit="length²")]
    """Area of its pieces."""
    edge: Annotated[Longs, Array("int64", EDGE, END)]
    """Nodes that are joined."""
    loop: Annotated[Bools, Array("bool", EDGE)]
    """Whether an edge closes a loop."""
    outside: Annotated[Bools, Array("bool", EDGE)]
    """Whether an edge or one of its ends leaves the body."""
    end: Annotated[Longs, Array("int64", LEAF)]
    """Node that holds each extremum of the frame, in their order."""
    branch: Annotated[Longs, Array("int64", NODE)]
    """Extremum at the end of each node's branch, −1 on the trunk and in loops."""
    reach: Annotated[Floats, Array("float64", LOOP)]
    """Share of the range of μ that each loop spans, longest first."""
    of_vertex: Annotated[Longs, Array("int64", VERTEX)]
    """The node that stands for each vertex, −1 outside the largest component."""
    degrees: tuple[int, ...]
    """Number of edges at each branch point, the most first."""
    replaced: int
    """Nodes that were replaced by finer ones because something was outside."""
