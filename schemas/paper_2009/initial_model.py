"""The graph of an initial frame as a tree of nodes, with the surface that follows them (2009, Sec. 2.3.1)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import CORNER, FACE, INFLUENCE, LEAF, NODE, VERTEX, XYZ

Longs = NDArray[np.int64]


class InitialModelParams(Params):
    """How the surface follows the nodes."""

    smoothing: float = Field(default=0.3, ge=0, le=2)
    """Width over which the surface blends from node to node, share of the distance between nodes."""
    spacing: float = Field(default=0.04, ge=0, le=1)
    """Least distance of nodes along a branch, share of the root of the area; nearer ones are one. 0 keeps every node."""


class InitialModel(Artifact):
    """A tree of nodes, parents before children, and the mesh of its frame bound to them."""

    frame: int
    """Source frame number of the initial frame."""
    size: float
    """Root of the surface's area, length."""
    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """The initial frame's mesh."""
    faces: Annotated[Longs, Array("int64", FACE, CORNER)]
    """Its faces."""
    node: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """Position of every node."""
    parents: Annotated[Longs, Array("int64", NODE)]
    """Parent of every node, −1 for the root."""
    joint: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """The point about which a node turns against its parent, amid the edge between them."""
    branch: Annotated[Longs, Array("int64", NODE)]
    """Leaf at the end of each node's branch, −1 on the trunk."""
    end: Annotated[Longs, Array("int64", LEAF)]
    """Node that holds each leaf."""
    track: Annotated[Longs, Array("int64", LEAF)]
    """The limb that each leaf is: row of `Leaves`, −1 for none that was followed."""
    leaf_vertex: Annotated[Longs, Array("int64", LEAF)]
    """Vertex at each leaf."""
    label: Annotated[Longs, Array("int64", VERTEX)]
    """The node that carries each vertex."""
    bound: Annotated[Longs, Array("int64", VERTEX, INFLUENCE)]
    """Nodes that each vertex follows, heaviest first."""
    weight: Annotated[Floats, Array("float64", VERTEX, INFLUENCE)]
    """How much, summing to 1."""
