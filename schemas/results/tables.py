"""Motion, positions, confidence, angles and lengths as tables."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import Exported


class TablesParams(Params):
    """Form of the tables, and how velocities are smoothed."""

    form: Literal["csv", "parquet"] = "csv"
    """csv, or parquet, which needs pip install 'kinetree[parquet]'."""
    window: float = Field(default=0.25, gt=0)
    """Seconds of motion that each velocity and acceleration is fitted to (Savitzky-Golay)."""
    degree: int = Field(default=3, ge=2, le=5)
    """Degree of the polynomials that are fitted."""


class Tables(Exported):
    """motion, joints, positions, confidence, angles, bones, turns, and joint_angles and gait where they can be told."""

    samples: int | None
    """Frames that each velocity is fitted to; None where the frame rate is not known, so that there are none."""
    seconds: float | None
    """The time that they span, at even spacing."""
    degree: int
    """Degree of the polynomials."""
