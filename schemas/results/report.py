"""One page that shows what a run found and how far it is to be believed."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Params
from kinetree.schemas.dims import BYTE

RUN = "null/*what ran*/"
"""Stands in a page where what ran is to be told."""


class ReportParams(Params):
    """How much of a sequence the page holds."""

    title: str = ""
    """What the page is called; empty names it after the number of frames."""
    frames: int = Field(default=90, ge=1, le=1000)
    """Frames that play at most; more make the page slow to open."""
    vertices: int = Field(default=4000, ge=50)
    """Vertices of the aligned mesh at most."""
    input_vertices: int = Field(default=2500, ge=50)
    """Vertices of an input mesh at most."""
    views: int = Field(default=4, ge=1, le=12)
    """Frames of which still pictures are drawn."""


class Report(Artifact):
    """A page of HTML, but for what is known only when the run is over."""

    text: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The page in UTF-8."""
