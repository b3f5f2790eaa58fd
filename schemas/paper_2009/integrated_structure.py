"""One kinematic structure of the sequence: of each branch the most detailed (2009, Sec. 2.4, Fig. 3)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Floats, Ints
from kinetree.schemas.dims import FRAME, LEAF, NODE, VERTEX
from kinetree.schemas.paper_2009.initial_model import InitialModel

Longs = NDArray[np.int64]


class IntegratedStructure(InitialModel):
    """The initial model on which all branches were brought together, its clusters, and the order in which it reaches frames."""

    frames: tuple[int, ...]
    """Source frame number of every frame of the sequence, ascending."""
    structure: int
    """The structure whose initial model it is."""
    source: Annotated[Longs, Array("int64", LEAF)]
    """The structure from which each branch's clusters are."""
    cluster: Annotated[Longs, Array("int64", NODE)]
    """Cluster of every node."""
    part: Annotated[Longs, Array("int64", VERTEX)]
    """Cluster of every vertex."""
    correlation: Annotated[Floats, Array("float64", NODE)]
    """r(i, j) of every node with its parent in its own structure; 1 for the root."""
    before: Annotated[Ints, Array("int32", FRAME)]
    """Position of the frame whose model each frame starts from; −1 for the initial frame."""

    def previous(self, member: int) -> int | None:
        """The frame whose model a frame starts from; None for the initial frame."""
        at = int(self.before[self.frames.index(member)])
        return None if at < 0 else self.frames[at]
