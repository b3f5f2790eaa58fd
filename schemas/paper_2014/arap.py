"""An interval's reference in one of its frames, and how it is deformed to it (2014, Sec. 5.3; Sorkine, Alexa 2007)."""

from collections.abc import Sequence

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.registration.alignment import Alignment


class Arap(Alignment):
    """Where every vertex of the interval's reference is in this frame; the same fields as every alignment."""

    rigid_residual: float
    """How far the reference, moved as one rigid body, is off the frame's surface; 1 is what noise and triangles explain."""

    @property
    def is_rigid(self) -> bool:
        """Whether the frame does not show that any part moved against another."""
        return self.rigid_residual <= 1.0


class ArapParams(Params):
    """How strongly the geodesic mapping constrains the deformation, and how long it is iterated."""

    length: float = Field(default=0.16, gt=0, le=10)
    """Length over which errors of the mapping are averaged, share of the root of the area; the papers give no weight."""
    steps: int = Field(default=30, ge=1, le=10_000)
    """Local and global steps at most; the papers give no number."""
    tolerance: float = Field(default=1e-4, ge=0, lt=1)
    """Steps end when vertices move by less than this share of the body's radius of gyration."""


def by_interval(alignments: Sequence[Arap], references: Sequence[IntervalReference]) -> list[list[Arap]]:
    """The alignments of each interval, frame by frame.

    alignments : of all frames of all intervals, in order
    references : of all intervals, in order
    """
    rest = iter(alignments)
    return [[next(rest) for _ in reference.frames] for reference in references]
