"""Which nodes of the deformation graph have moved as one."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.pieces import Pieces
from kinetree.schemas.refit import FirstRefit
from kinetree.schemas.template import Template
from kinetree.tasks.numerics.pieces import pieces as numerics
from kinetree.tasks.pose import graph, pose


@task()
def pieces(template: Template, refit: tuple[FirstRefit, ...]) -> Pieces:
    """Merges nodes that one rigid motion carries in every frame (ours)."""
    if not len(template.nodes):
        return Pieces(label=np.empty(0, np.int32))
    return Pieces(label=numerics(graph(template), [pose(p) for p in refit]).astype(np.int32))
