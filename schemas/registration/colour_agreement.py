"""Whether the colours of the frames agree with those of the reference, so that they may hold the alignment (ours)."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import FRAME, RGB, VERTEX


class ColourAgreement(Artifact):
    """How far the reference's colours explain those of every tracked frame; no frames where there are no colours."""

    frames: tuple[int, ...]
    """Source frame number of every frame with colours that the body is learned from, ascending, without the reference."""
    share: Annotated[Floats, Array("float64", FRAME)]
    """Share of the variance of each frame's colours, beyond what light from one side explains, that the reference's explain."""
    is_used: bool
    """Whether colours count in the passes: their agreement suffices in more than half of these frames."""
    colour: Annotated[NDArray[np.uint8], Array("uint8", VERTEX, RGB)]
    """sRGB of the reference's vertices, 0 to 255; no rows where colours do not count."""

    @classmethod
    def none(cls) -> "ColourAgreement":
        """That of a body without colours."""
        return cls(frames=(), share=np.empty(0), is_used=False, colour=np.empty((0, 3), np.uint8))
