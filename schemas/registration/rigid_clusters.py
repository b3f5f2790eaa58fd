"""Pieces of the deformation graph that have moved as one (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Ints
from kinetree.schemas.dims import NODE


class RigidClusters(Artifact):
    """Which nodes have moved as one piece in all frames of the first refit; empty for fixed connectivity."""

    label: Annotated[Ints, Array("int32", NODE)]
    """Number of every node's piece, in the order of each piece's first node."""
