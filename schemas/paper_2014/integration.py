"""Kinematic cones that hold in all intervals (2014, Sec. 6.1.3; Fig. 12)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Ints
from kinetree.schemas.dims import ANNULUS, CONE, RUNG
from kinetree.schemas.paper_2014.annuli import Joint


class Integration(Artifact):
    """The rigid annuli of every cone: those that are rigid in all intervals."""

    floor: float
    """Errors per vertex below this counted as this much, share of the root of the area."""
    joint: Joint
    """How annuli of joints were chosen, see `AnnuliParams.joint`."""
    theta: float
    """θ_r, the threshold of Eq. 12."""
    rigid: Annotated[Bools, Array("bool", CONE, ANNULUS)]
    """Whether annulus k of each cone is rigid; true beyond a cone's last annulus."""
    clusters: Annotated[Ints, Array("int32", RUNG)]
    """Number of rigid areas in all cones together at each threshold (Fig. 11)."""
