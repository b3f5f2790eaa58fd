"""The first refit with every limb in the turn that it has over the whole sequence."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.pieces import Pieces
from kinetree.schemas.refit import FirstRefit
from kinetree.schemas.template import Template
from kinetree.schemas.turns import Turns
from kinetree.schemas.twist import Twist
from kinetree.schemas.untwisting import Untwisting
from kinetree.tasks.numerics import turns as numerics
from kinetree.tasks.pose import graph, pose


@task(over="frame")
def untwisting(template: Template, refit: FirstRefit, pieces: Pieces, turns: Turns, twist: Twist) -> Untwisting:
    """Puts limbs that had lost their twist where the whole sequence says they are (ours)."""
    found = pose(refit)
    chosen = twist.turn[(twist.misfit == turns.misfit).all(axis=(1, 2)).argmax()]
    if (chosen >= 0).any():
        tried = numerics.Turns(turns.angle, turns.misfit, turns.rotation, turns.place)
        found = numerics.untwisted(graph(template), found, pieces.label.astype(np.int64), tried, chosen)
    return Untwisting(steps=refit.steps, rotation=found.rotation, translation=found.translation)
