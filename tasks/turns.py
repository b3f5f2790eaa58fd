"""Limbs tried in other turns about their own axis, in one frame."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.mesh import Mesh
from kinetree.schemas.pieces import Pieces
from kinetree.schemas.refit import FirstRefit
from kinetree.schemas.template import Template
from kinetree.schemas.turns import Turns
from kinetree.tasks.numerics import turns as numerics
from kinetree.tasks.pose import graph, pose, target


@task(over="frame")
def turns(mesh: Mesh, template: Template, refit: FirstRefit, pieces: Pieces) -> Turns:
    """Fits every limb as a rigid body from several turns about its axis (ours)."""
    if not len(template.nodes):
        none = (0, numerics.TURNS)
        return Turns(angle=np.empty(none), misfit=np.empty(none), rotation=np.empty((*none, 3, 3)), place=np.empty((*none, 3)))
    found = numerics.turns(graph(template), pose(refit), target(mesh, template), pieces.label.astype(np.int64))
    return Turns(**found._asdict())
