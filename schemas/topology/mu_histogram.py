"""How μ is distributed over one frame's surface (2014, Sec. 4)."""

from typing import Annotated, Literal

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import FINE

Normalisation = Literal["sequence", "frame"]


class MuHistogramParams(Params):
    """How μ is counted where frames are compared."""

    normalisation: Normalisation = "sequence"
    """sequence: μ / area^1.5, a vertex counting its area; frame: the paper's letter, μ as it is, a vertex counting 1."""


class MuHistogram(Artifact):
    """A fine histogram of μ, all that a comparison of frames needs of one."""

    normalisation: Normalisation
    """What was counted; comparing frames follows it."""
    low: float
    """Least value."""
    high: float
    """Greatest value."""
    mass: Annotated[Floats, Array("float64", FINE)]
    """Share of the weight in each of the even bins from low to high."""
