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
    """What the page says and how finely it shows the body."""

    title: str = ""
    """Title of the page; empty: made of the numbers of joints and frames."""
    vertices: int = Field(default=4000, ge=50)
    """Most vertices of the aligned mesh in the player."""


class Report(Artifact):
    """A page of HTML without the record of the run, which is inserted when the run has ended."""

    text: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The page in UTF-8."""
