"""The moving body as the player of the report reads it (ours)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Params
from kinetree.schemas.dims import BYTE


class PlayedBodyParams(Params):
    """How finely the page shows the body."""

    vertices: int = Field(default=4000, ge=50)
    """Most vertices of the aligned mesh in the player."""


class PlayedBody(Artifact):
    """All that plays, reduced to what a page can hold."""

    description: str
    """What the player reads first, as JSON: joints, frames, and where each array begins."""
    omitted: tuple[str, ...]
    """What the page does not show, in sentences."""
    block: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The arrays one after the other, deflated."""
