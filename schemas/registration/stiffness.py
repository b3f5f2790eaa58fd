"""How stiff every tie of the deformation graph is: what never bends is bone, what bends in some frame is a joint (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats
from kinetree.schemas.dims import TIE


class Stiffness(Artifact):
    """Learned from the poses of all frames."""

    stiffness: Annotated[Floats, Array("float64", TIE)]
    """1 for a tie that never bends, near 0 for one that does."""


class FirstStiffness(Stiffness):
    """Learned from the tracked and repaired poses."""


class SecondStiffness(Stiffness):
    """Learned from the first refit with twists brought back."""


class ThirdStiffness(Stiffness):
    """Learned from the second refit."""
