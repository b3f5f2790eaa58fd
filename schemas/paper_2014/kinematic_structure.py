"""How bones are given fixed lengths (2014, Sec. 6.3.2; Aguiar 2006); the result is a `Skeleton`."""

from pydantic import Field

from kinetree.schemas.array import Params


class KinematicStructureParams(Params):
    """What the poses are fitted to."""

    surface: float = Field(default=0.01, gt=0, le=100)
    """Weight of a rigid part's surface against one joint; the surface shows the roll of a bone, which joints do not."""
