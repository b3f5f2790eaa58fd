"""Annuli of one cone in one interval clustered by merge-error, for every threshold that is tried (2014, Sec. 6.1.2)."""

from typing import Annotated, Literal

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints, Params
from kinetree.schemas.dims import ANNULUS, RUNG

THRESHOLDS = tuple(round(1.1 + 0.1 * step, 1) for step in range(20))
"""The values of θ_r that are tried unless others are set: the paper's 1.2 and its surroundings up to 3."""

Joint = Literal["clustered", "least_rigid"]


class AnnuliParams(Params):
    """When an annulus joins the cluster before it."""

    thresholds: tuple[float, ...] = Field(default=THRESHOLDS, min_length=1)
    """θ_r of Eq. 12. Of several, the one that gives the most rigid areas is taken, as for Fig. 11, where it is 1.2."""
    floor: float = Field(default=0.0005, gt=0)
    """Errors per vertex below this count as this much, share of the root of the area; without errors Eq. 11 would be 0 / 0."""
    joint: Joint = "least_rigid"
    """Which annulus is a joint: clustered, the first that does not join, by Eq. 12 alone; least_rigid, that or the last that
    did join, whichever has the larger self-error."""


class Annuli(Artifact):
    """Which annuli of one cone are rigid in one interval, at every threshold."""

    interval: int
    """Number of the interval."""
    cone: int
    """Number of the cone, the same in all intervals."""
    floor: float
    """Errors per vertex below this counted as this much, share of the root of the area."""
    joint: Joint
    """How annuli of joints were chosen, see `AnnuliParams.joint`."""
    theta: Annotated[Floats, Array("float64", RUNG)]
    """The thresholds θ_r."""
    annulus: Annotated[Ints, Array("int32", ANNULUS)]
    """The annuli of the cone that have vertices, ascending from the leaf."""
    rigid: Annotated[Bools, Array("bool", RUNG, ANNULUS)]
    """Whether an annulus is clustered with another; a single one is a joint or part of one."""
    merge_error: Annotated[Floats, Array("float64", RUNG, ANNULUS)]
    """Mean merge-error of each annulus against the cluster before it (Eq. 12); 1 for the first of a cluster."""
