"""Which way is up."""

from kinetree.pipeline.task import task
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection, UpDirectionParams
from kinetree.tasks.numerics.topology import up_direction as numerics


@task()
def up_direction(leaves: Leaves, params: UpDirectionParams) -> UpDirection:
    """Finds up by the ground, on which several leaves stand and below which none is (ours)."""
    if params.up is not None:
        return UpDirection(up=params.up, confidence=1.0)
    best = numerics.up_direction(leaves.positions)
    return UpDirection(up=numerics.DIRECTIONS[best.direction], confidence=best.confidence)
