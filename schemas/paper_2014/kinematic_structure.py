"""How the tree of joints is given fixed lengths (2014, Sec. 6.3.2; Aguiar 2006); the result is a `Skeleton`."""

from pydantic import Field

from kinetree.schemas.array import Params


class KinematicStructureParams(Params):
    """What is fitted."""

    surface: float = Field(default=1.0, gt=0, le=100)
    """Weight of a rigid body's surface against one joint: it says how bones turn about themselves, which joints cannot."""
