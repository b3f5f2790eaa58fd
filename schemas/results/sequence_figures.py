"""What a table over many sequences says of one."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact
from kinetree.schemas.dims import PIXEL_COLUMN, PIXEL_ROW, RGB
from kinetree.schemas.results.verdict import Level


class SequenceFigures(Artifact):
    """Counts, confidence and errors of one sequence, and a small picture of its body."""

    frames: int
    """Number of measured frames."""
    unit: str | None
    """Unit of all lengths; None where it is not known."""
    height: float
    """Longest side of the reference mesh's box, length."""
    vertices: int
    """Vertices of the reference mesh."""
    joints: int
    """Joints that turn, root and leaves left out."""
    leaves: int
    """Ends of bones."""
    bones: int
    """Links between joints."""
    confidence: float
    """Mean over joints and frames, 0 to 1."""
    outliers: int
    """Frames that the alignment explains clearly worse than the others."""
    verdict: Level
    """Whether the result can be relied on."""
    verdict_words: str
    """The same in one sentence, with what speaks against it."""
    truth: str
    """Name of the truth; empty where there is none."""
    scored: int | None
    """True joints that should be found; None without a truth, as are all below."""
    found: int | None
    """Those that were."""
    spurious: int | None
    """Joints that are no true joint."""
    error: float | None
    """Mean distance from the true joints that were found, length; None also where none was."""
    percent: float | None
    """The same, % of the height."""
    picture: Annotated[NDArray[np.uint8], Array("uint8", PIXEL_ROW, PIXEL_COLUMN, RGB)]
    """The reference mesh in the colours of its parts, with the skeleton, sRGB."""
