"""Which limbs had lost their roll in tracking, and the stiffness with which frames are fitted in this pass (ours)."""

from typing import Annotated

import numpy as np

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints
from kinetree.schemas.dims import EDGE, FRAME, LIMB, NODE


class Roll(Artifact):
    """The candidate that each limb takes in every frame, chosen over the whole sequence."""

    frames: tuple[int, ...]
    """Source frame number of every frame that the body is learned from, ascending."""
    candidate: Annotated[Ints, Array("int32", FRAME, LIMB)]
    """The candidate of every limb in each frame, −1 where it stays as it was; no limbs in passes without a search."""
    limb: Annotated[Ints, Array("int32", NODE)]
    """Number of the limb of every node where that limb rolled in this pass or an earlier one, else −1."""
    stiffness: Annotated[Floats, Array("float64", EDGE)]
    """Stiffness of every edge for the fits of this pass: learned from poses with roll corrected, loose where limbs rolled."""

    def row(self, frame: int) -> Ints | None:
        """(limb,) the candidates chosen in a source frame; None for a frame that nothing is learned from."""
        return self.candidate[self.frames.index(frame)] if frame in self.frames else None

    @property
    def rolls(self) -> Bools:
        """(limb,) whether it rolled in some frame of those that the body is learned from."""
        return np.asarray((self.candidate >= 0).any(axis=0))
