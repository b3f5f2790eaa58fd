"""How alike the Reeb graphs of all frames are (2009, Sec. 2.3; Tung and Schmitt 2005)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import FRAME, OTHER_FRAME


class SimilarityParams(Params):
    """Which attributes of nodes count."""

    weight: float = Field(default=0.5, ge=0, le=1)
    """Weight of a node's area against the breadth of its piece."""


class Similarity(Artifact):
    """The correlation of every two frames' graphs."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    similarity: Annotated[Floats, Array("float64", FRAME, OTHER_FRAME)]
    """0 to 1, 1 for equal graphs."""
