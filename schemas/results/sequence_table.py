"""All sequences of a data set in one table."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Params
from kinetree.schemas.dims import PIXEL_COLUMN, PIXEL_ROW, RGB, SEQUENCE
from kinetree.schemas.results.outcomes import SequenceOutcome
from kinetree.schemas.results.verdict import Level


class SequenceRow(Params):
    """One sequence: what became of it and, where it has a result, its figures."""

    outcome: SequenceOutcome
    """What became of it."""
    frames: int | None = None
    """Number of measured frames; None without a result, as are all below."""
    unit: str | None = None
    """Unit of all lengths; None also where it is not known."""
    height: float | None = None
    """Longest side of the reference mesh's box, length."""
    vertices: int | None = None
    """Vertices of the reference mesh."""
    joints: int | None = None
    """Joints that turn."""
    leaves: int | None = None
    """Ends of bones."""
    bones: int | None = None
    """Links between joints."""
    confidence: float | None = None
    """Mean over joints and frames, 0 to 1."""
    outliers: int | None = None
    """Frames that the alignment explains clearly worse than the others."""
    verdict: Level | None = None
    """Whether the result can be relied on: good, except (good but for what is named), unusable."""
    verdict_words: str | None = None
    """The same in one sentence, with what speaks against it."""
    truth: str | None = None
    """Name of the truth; empty where there is none."""
    scored: int | None = None
    """True joints that should be found; None also without a truth, as are all below."""
    found: int | None = None
    """Those that were."""
    spurious: int | None = None
    """Joints that are no true joint."""
    error: float | None = None
    """Mean distance from the true joints that were found, length."""
    percent: float | None = None
    """The same, % of the height."""
    picture: int | None = None
    """Place of its picture among all pictures."""


class SequenceTable(Artifact):
    """All sequences of a data set, in the order of their names."""

    rows: tuple[SequenceRow, ...]
    """One a sequence."""
    pictures: Annotated[NDArray[np.uint8], Array("uint8", SEQUENCE, PIXEL_ROW, PIXEL_COLUMN, RGB)]
    """Of the sequences that have a result."""
