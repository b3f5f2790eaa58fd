"""The runs of frames in which the body's topology stays (2014, Sec. 4)."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Index, Ints, Params
from kinetree.schemas.dims import CUE, INTERVAL, TRANSITION

Cue = Literal["correlation", "leaves", "loops", "components", "euler"]


class IntervalsParams(Params):
    """Where a sequence is cut."""

    rule: Literal["robust", "fixed"] = "robust"
    """robust: the threshold is found in the series itself; fixed: cut wherever C(t) is below `threshold`, as the paper does."""
    tracked: Literal["cut", "whole"] = "cut"
    """A sequence of fixed connectivity. cut: as every other; whole: one interval, as the paper skips Step I (Sec. 7)."""
    threshold: float = Field(default=0.95, ge=-1, le=1)
    """For the fixed rule: C(t) below which to cut; the paper gives no number."""
    high: float = Field(default=2.0, ge=0)
    """A drop of the correlation begins above this many robust standard deviations of log(1 − C)."""
    low: float = Field(default=1.5, ge=0)
    """The drop extends as far as it stays above this many."""
    drop: float = Field(default=0.02, ge=0, le=2)
    """Within the drop 1 − C must exceed this."""
    minimum: int = Field(default=3, ge=1)
    """Frames an interval has at least."""
    cues: tuple[Cue, ...] = ("correlation", "leaves", "loops")
    """What may cut: correlation of μ; persistence of the leaves; reach of loops; number of components; Euler characteristic."""
    step: float = Field(default=0.12, gt=0, le=1)
    """Share of the range of μ by which a leaf's persistence or a loop's reach must change for good."""


class Intervals(Artifact):
    """A partition of the frames; each interval is one stretch of unchanged topology."""

    opens: ClassVar[tuple[str, ...]] = ("interval", "interval/frame")
    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    begin: Annotated[Ints, Array("int32", INTERVAL)]
    """Position, among the frames, of each interval's first."""
    end: Annotated[Ints, Array("int32", INTERVAL)]
    """Position of each interval's last frame, included."""
    z: Annotated[Floats, Array("float64", TRANSITION)]
    """How far each transition stands out: robust z score of log(1 − C)."""
    cues: tuple[tuple[str, ...], ...]
    """What made each cut; cut i lies between interval i and the next."""
    strengths: Annotated[Floats, Array("float64", CUE, TRANSITION)]
    """How near each cue by itself came to cutting at each transition; 1 is its threshold. Rows in the order of `cue_names`."""
    cue_names: tuple[str, ...]
    """The cues, whether they were allowed to cut or not."""
    threshold: float
    """z, or C for the fixed rule, that a transition had to pass."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The intervals, numbered from 0, and the source frames of one."""
        if space == "interval":
            return range(len(self.begin))
        return self.frames[int(self.begin[index[0]]) : int(self.end[index[0]]) + 1]
