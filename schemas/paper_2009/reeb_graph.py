"""The multiresolution Reeb graph of one frame (2009, Sec. 2.1; Hilaga 2001)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import EDGE, END, NODE, VERTEX, XYZ

Longs = NDArray[np.int64]


class ReebGraphParams(Params):
    """How finely the range of μ is cut."""

    levels: int = Field(default=6, ge=1, le=10)
    """Resolutions beyond the single band of the coarsest; the finest has 2 to the power of this many bands."""


class ReebGraph(Artifact):
    """Nodes of all resolutions, those of the finest first; a node is a connected piece of the surface in one band of μ."""

    level: Annotated[Longs, Array("int64", NODE)]
    """Resolution of each node, 0 the finest."""
    band: Annotated[Longs, Array("int64", NODE)]
    """Its band, from low μ to high."""
    parent: Annotated[Longs, Array("int64", NODE)]
    """Node of the next coarser resolution that it is a part of, −1 on the coarsest."""
    area: Annotated[Floats, Array("float64", NODE, unit="length²")]
    """Area of its piece."""
    centre: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """Centre of area of its piece."""
    edge: Annotated[Longs, Array("int64", EDGE, END)]
    """Nodes of the finest resolution whose pieces meet."""
    contour: Annotated[Floats, Array("float64", EDGE, XYZ, unit="length")]
    """Middle of the contour at which they meet."""
    of_vertex: Annotated[Longs, Array("int64", VERTEX)]
    """The finest node whose piece holds each vertex, −1 outside the largest component."""
