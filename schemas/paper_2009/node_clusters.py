"""The piecewise kinematic structure: nodes that move as one rigid body (2009, Sec. 2.3.1, Eqs. 5, 6; Fig. 2)."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import NODE, VERTEX

Longs = NDArray[np.int64]


class NodeClustersParams(Params):
    """What makes neighbouring nodes one rigid body."""

    rule: Literal["removal", "correlation"] = "removal"
    """removal: a node stays as long as the motion is not explained without it; correlation: Eq. 5, with `threshold`."""
    removal_cost: float = Field(default=0.005, gt=0)
    """Motion left unexplained without a cluster, share of the root of the area; a cluster that costs less is removed."""
    threshold: float = Field(default=0.9, ge=-1, le=1)
    """r(i, j) from which on two neighbouring nodes are one rigid body; the paper gives no number."""
    relative: bool = True
    """Whether the mean velocity of all nodes is taken out of Eq. 5; with it the nodes of a walker correlate everywhere."""
    one_too_few: bool = False
    """Whether the mean velocity divides by t_e − t_b, as Eq. 6 has it, and not by the number of velocities."""


class NodeClusters(Artifact):
    """The clusters of one initial model."""

    structure: int
    """The structure."""
    cluster: Annotated[Longs, Array("int64", NODE)]
    """Cluster of every node."""
    part: Annotated[Longs, Array("int64", VERTEX)]
    """Cluster of every vertex of the initial frame's mesh."""
    correlation: Annotated[Floats, Array("float64", NODE)]
    """r(i, j) of every node with its parent (Eq. 5); 1 for the root."""
