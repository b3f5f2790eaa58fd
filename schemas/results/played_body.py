"""The moving body as the player of the report reads it (ours)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params
from kinetree.schemas.dims import BYTE, ROW, SAMPLE, XYZ


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
    """The arrays one after the other, deflated; the stream is not ended, so that more can follow."""
    size: int
    """Of the arrays, bytes."""
    checksum: int
    """Adler-32 of the arrays."""
    reference_vertex: Annotated[Ints, Array("int32", SAMPLE)]
    """The vertices of the reference mesh that play."""
    axes: Annotated[Floats, Array("float64", XYZ, ROW)]
    """The axes of the view, as columns."""
