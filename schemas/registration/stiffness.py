"""How stiff every edge of the deformation graph is, learned from the poses of all frames in the pass before (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import EDGE, NODE


class Stiffness(Artifact):
    """What never bends is bone, what bends in some frame is a joint."""

    stiffness: Annotated[Floats, Array("float64", EDGE)]
    """1 for an edge that never bends, near 0 for one that does."""
    cluster: Annotated[Ints, Array("int32", NODE)]
    """Rigid cluster of every node, numbered by its first node: nodes that one rigid motion carries in every frame; −1 for all
    nodes in passes before clusters are sought."""
