"""Which frames of an alignment are to be believed (ours)."""

from itertools import pairwise
from typing import Annotated

import numpy as np

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
    doubted: Annotated[Floats, Array("float64", FRAME)]
    """Share of the body's vertices that are hardly to be believed in each frame."""
    trusted: Annotated[Bools, Array("bool", FRAME)]
    """False where a frame is explained clearly worse than the others; its vertices are weighed down."""

    def remarks(self) -> tuple[str, ...]:
        """Frames that are not trusted, and frames of which a part is not."""
        told = []
        strange, partly = ~self.trusted, self.trusted & (self.doubted > 0.05)
        if strange.any():
            told.append(f"{self._runs(strange)} not trusted: the body does not explain what is seen there")
        if partly.any():
            most = float(self.doubted[partly].max())
            told.append(f"{self._runs(partly)} trusted in part: up to {most:.0%} of the body is out of sight or in doubt")
        return tuple(told)

    def _runs(self, flags: Bools) -> str:
        """Frame numbers, runs as first–last, and the verb."""
        at = np.flatnonzero(flags)
        ends = [-1, *(i for i, (a, b) in enumerate(pairwise(at)) if b > a + 1), len(at) - 1]
        spans = [(self.frames[at[a + 1]], self.frames[at[b]]) for a, b in pairwise(ends)]
        numbers = ", ".join(f"{a}" if a == b else f"{a}–{b}" for a, b in spans)
        return f"frame {numbers} is" if len(at) == 1 else f"frames {numbers} are"
