"""How limbs turned about their own axis over the whole sequence."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.pieces import Pieces
from kinetree.schemas.reference import Reference
from kinetree.schemas.template import Template
from kinetree.schemas.turns import Turns
from kinetree.schemas.twist import Twist
from kinetree.tasks.numerics.turns import limbs
from kinetree.tasks.numerics.twist import choices
from kinetree.tasks.pose import graph


@task()
def twist(turns: Mapping[int, Turns], template: Template, pieces: Pieces, reference: Reference) -> Twist:
    """Chooses for every limb the way through its turns that fits clearly better than where it was tracked (ours)."""
    frames = tuple(turns)
    angle, misfit = (np.stack([getattr(t, name) for t in turns.values()]) for name in ("angle", "misfit"))
    turn = choices(angle, misfit, frames.index(reference.frame))
    limb = np.full(len(template.nodes), -1, np.int32)
    if (turn >= 0).any():
        for k, one in enumerate(limbs(graph(template), pieces.label.astype(np.int64))):
            limb[one.node] = k if (turn[:, k] >= 0).any() else -1
    return Twist(frames=frames, misfit=misfit, turn=turn.astype(np.int32), limb=limb)
