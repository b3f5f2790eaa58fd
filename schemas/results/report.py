"""One page that shows the result of a run and how reliable it is."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Params
from kinetree.schemas.dims import BYTE

RUN = "null/*what ran*/"
"""Stands in a page at the place where the record of the run is inserted."""


class ReportParams(Params):
    """How much of a sequence the page shows."""

    title: str = ""
    """Title of the page; empty: made of the numbers of joints and frames."""
    frames: int = Field(default=90, ge=1, le=1000)
    """Most frames that the player shows; with more the page opens slowly."""
    vertices: int = Field(default=4000, ge=50)
    """Most vertices of the aligned mesh in the player."""
    input_vertices: int = Field(default=2500, ge=50)
    """Most vertices of an input mesh in the player."""
    views: int = Field(default=4, ge=1, le=12)
    """Number of frames in pictures of the body."""


class Report(Artifact):
    """A page of HTML without the record of the run, which is inserted when the run has ended."""

    text: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The page in UTF-8."""
