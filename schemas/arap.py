"""How an interval's reference is deformed to its frames (2014, Sec. 5.3; Sorkine, Alexa 2007); the result is an `Alignment`."""

from pydantic import Field

from kinetree.schemas.array import Params


class ArapParams(Params):
    """How rigid, and how long."""

    length: float = Field(default=0.16, gt=0, le=10)
    """What the mapping errs by over less than this is averaged, share of the root of the area; the papers give no weight."""
    steps: int = Field(default=30, ge=1, le=10_000)
    """Local and global steps at most; the papers give no number."""
    tolerance: float = Field(default=1e-4, ge=0, lt=1)
    """Steps end when vertices move by less than this share of the body's radius of gyration."""
