"""From which frame each initial model is taken, and in which order it is deformed to the others (2009, Sec. 2.3)."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from kinetree.schemas.array import Array, Artifact, Index, Ints, Params
from kinetree.schemas.dims import FRAME, STRUCTURE


class InitialFramesParams(Params):
    """For which frames there is one initial model, and from where it reaches a frame."""

    scope: Literal["sequence", "interval"] = "sequence"
    """sequence: one model for all frames, from the best coherent one; interval: one for each coherent interval (paper)."""
    initial: Literal["extended", "similar"] = "extended"
    """similar: the frame most similar to all, as in the paper; extended: the coherent one whose ends are farthest apart."""
    start: Literal["neighbour", "correlation"] = "neighbour"
    """Which deformed model a frame starts from: its neighbour's, or that of the frame most similar to it, as in the paper."""


class InitialFrames(Artifact):
    """The piecewise structures: their initial frames, and their frames in the order of time."""

    opens: ClassVar[tuple[str, ...]] = ("structure", "structure/frame")
    frames: tuple[int, ...]
    """Source frame number of every frame of the sequence, ascending."""
    initial: Annotated[Ints, Array("int32", STRUCTURE)]
    """Position of each structure's initial frame."""
    structure: Annotated[Ints, Array("int32", FRAME)]
    """The structure that each frame is in, −1 for none."""
    before: Annotated[Ints, Array("int32", FRAME)]
    """Position of the frame whose deformed model each frame starts from; −1 for initial frames and outside structures."""
    coherent: bool
    """Whether any interval is coherent; if not, the frames with the most ends and the fewest loops stand in."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The structures, numbered from 0, or the source frames of one."""
        if space == "structure":
            return range(len(self.initial))
        return [frame for frame, own in zip(self.frames, self.structure.tolist(), strict=True) if own == index[0]]

    def previous(self, member: int) -> int | None:
        """The frame whose deformed model a frame starts from; None for an initial frame."""
        at = int(self.before[self.frames.index(member)])
        return None if at < 0 else self.frames[at]
