"""How alike successive frames are in the distribution of μ (2014, Sec. 4, Eq. 2, Fig. 5)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import BIN, FRAME, TRANSITION


class CorrelationParams(Params):
    """How the histograms that are compared are made."""

    bins: int = Field(default=100, ge=2, le=2000)
    """Bins of a histogram; the paper has 100."""
    smoothing: float = Field(default=2.0, ge=0, le=100)
    """Standard deviation, in bins, of the Gaussian that keeps motion from looking like contact; not used per frame."""


class Correlation(Artifact):
    """C(t) of the paper, and the histograms behind it."""

    histograms: Annotated[Floats, Array("float64", FRAME, BIN)]
    """Share of the surface in each bin."""
    correlation: Annotated[Floats, Array("float64", TRANSITION)]
    """C between frame t and the next, within −1 … 1; 1 where nothing changes."""
