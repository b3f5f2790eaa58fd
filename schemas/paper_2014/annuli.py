"""Annuli of one cone in one interval clustered by merge-error, for every threshold that is tried (2014, Sec. 6.1.2)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints, Params
from kinetree.schemas.dims import ANNULUS, RUNG

LADDER = tuple(round(1.1 + 0.1 * step, 1) for step in range(20))


class AnnuliParams(Params):
    """When an annulus moves like those before it."""

    thresholds: tuple[float, ...] = Field(default=LADDER, min_length=1)
    """θ_r: one, or several of which that with the most clusters is taken, as the paper does for Fig. 11, where it is 1.2."""
    floor: float = Field(default=0.002, ge=0)
    """Errors below this are noise, share of the root of the area; where nothing errs Eq. 11 is 0 / 0 and the paper silent."""


class Annuli(Artifact):
    """Which annuli are rigid, at every threshold."""

    floor: float
    """Below which errors are noise, share of the root of the area."""
    theta: Annotated[Floats, Array("float64", RUNG)]
    """The thresholds."""
    annulus: Annotated[Ints, Array("int32", ANNULUS)]
    """The annuli of the cone that have vertices, ascending from the leaf."""
    rigid: Annotated[Bools, Array("bool", RUNG, ANNULUS)]
    """Whether an annulus is clustered with another; a single one is a joint or part of one."""
    merge: Annotated[Floats, Array("float64", RUNG, ANNULUS)]
    """Mean merge-error of each annulus against the cluster before it (Eq. 12); 1 for the first of a cluster."""
