"""One cone in one interval (2014, Sec. 6.1.1)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Ints
from kinetree.schemas.dims import VERTEX


class Limb(Artifact):
    """The annuli of a cone, apart from all others, so that what changes elsewhere does not concern it."""

    number: int
    """The cone's number, the same in all intervals."""
    recovered: bool
    """Whether its leaf is not seen in the interval."""
    ring: Annotated[Ints, Array("int32", VERTEX)]
    """Annulus of every vertex of the interval's reference, −1 beyond the cone."""
