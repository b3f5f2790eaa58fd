"""Parts on the surfaces of all frames, as the numerics take them."""

import numpy as np

from kinetree.schemas.structure.laid_parts import LaidParts
from kinetree.tasks.numerics.structure import laid_parts as numerics
from kinetree.tasks.numerics.structure.hinge_places import HingeCosts


def joined(laid: tuple[LaidParts, ...]) -> numerics.LaidParts | None:
    """All frames together, as the numerics take them; None where no part was laid."""
    if not laid:
        return None
    first, of_frames = laid[0], ("frame", "rotation", "translation", "stiffness", "square")
    rows = {name: np.concatenate([getattr(run, name) for run in laid]) for name in of_frames}
    square = np.concatenate([run.hinge_square for run in laid])
    hinges = HingeCosts(np.array(first.hinge_joint), np.array(first.hinge_end), square)
    return numerics.LaidParts(joint=np.array(first.joint), **rows, hinges=hinges)
