"""Which frames the alignment explains (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Floats
from kinetree.schemas.dims import FRAME


class FrameConfidence(Artifact):
    """What the alignment knows about itself, frame by frame."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    residual: Annotated[Floats, Array("float64", FRAME)]
    """Median distance of the body to each frame's surface, share of the root of its area."""
    uncovered: Annotated[Floats, Array("float64", FRAME)]
    """Share of each frame's surface that the body does not explain."""
    unreliable: Annotated[Floats, Array("float64", FRAME)]
    """Share of the body's vertices whose confidence is below a half in each frame."""
    inlier: Annotated[Bools, Array("bool", FRAME)]
    """False where a frame is an outlier: explained clearly worse than the others. Only messages to people depend on it."""
