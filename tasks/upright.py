"""Which way is up."""

from kinetree.pipeline.task import task
from kinetree.schemas.leaves import Leaves
from kinetree.schemas.upright import Upright, UprightParams
from kinetree.tasks.numerics.upright import DIRECTIONS, upright_direction


@task()
def upright(leaves: Leaves, params: UprightParams) -> Upright:
    """Tells up by the ground, on which several leaves come to stand and none goes below (ours)."""
    if params.up is not None:
        return Upright(up=params.up, confidence=1.0)
    found = upright_direction(leaves.positions)
    return Upright(up=DIRECTIONS[found.direction], confidence=found.confidence)
