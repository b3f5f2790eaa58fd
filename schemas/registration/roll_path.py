"""How limbs turned about their own axis over the whole sequence (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import FRAME, LIMB, NODE, TURN


class RollPath(Artifact):
    """Which turn every limb takes in every frame."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    misfit: Annotated[Floats, Array("float64", FRAME, LIMB, TURN)]
    """What every frame said of its turns: by this a frame knows its own row."""
    turn: Annotated[Ints, Array("int32", FRAME, LIMB)]
    """The turn that every limb takes, −1 where it stays as it was."""
    limb: Annotated[Ints, Array("int32", NODE)]
    """Number of the limb that every node belongs to where that limb turned in some frame, else −1."""
