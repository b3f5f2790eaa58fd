"""An interval's reference in one of its frames, and how it is deformed to it (2014, Sec. 5.3; Sorkine, Alexa 2007)."""

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.registration.alignment import Alignment


class Arap(Alignment):
    """Where every vertex of the interval's own reference is in this frame, told as every alignment is."""

    moved: float
    """How far the reference, moved as one rigid body, stays off the frame's surface: 1 is what noise and triangles explain."""

    @property
    def still(self) -> bool:
        """Whether nothing tells that any part moved against another."""
        return self.moved <= 1.0


class ArapParams(Params):
    """How rigid, and how long."""

    length: float = Field(default=0.16, gt=0, le=10)
    """What the mapping errs by over less than this is averaged, share of the root of the area; the papers give no weight."""
    steps: int = Field(default=30, ge=1, le=10_000)
    """Local and global steps at most; the papers give no number."""
    tolerance: float = Field(default=1e-4, ge=0, lt=1)
    """Steps end when vertices move by less than this share of the body's radius of gyration."""
