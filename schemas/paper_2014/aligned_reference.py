"""Which extrema are leaves where one alignment serves the whole sequence; the result is an `IntervalReference`."""

from pydantic import Field

from kinetree.schemas.array import Params


class AlignedReferenceParams(Params):
    """Which extrema of the reference's frame are leaves."""

    threshold: float = Field(default=0.2, gt=0, lt=1)
    """Least persistence of a leaf, share of the range of μ; as `extrema.threshold` of the preset paper-2014."""
