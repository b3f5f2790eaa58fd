"""One page that shows the result of a run and how reliable it is."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Params
from kinetree.schemas.dims import BYTE

RUN = "null/*what ran*/"
"""Stands in a page at the place where the record of the run is inserted."""


class ReportParams(Params):
    """What the page says."""

    title: str = ""
    """Title of the page; empty: made of the numbers of joints and frames."""


class Report(Artifact):
    """A page of HTML without the record of the run, which is inserted when the run has ended."""

    text: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The page in UTF-8."""
