"""Which way is up."""

from kinetree.pipeline.task import task
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection, UpDirectionParams
from kinetree.tasks.numerics.topology.up_direction import DIRECTIONS
from kinetree.tasks.numerics.topology.up_direction import up_direction as direction


@task()
def up_direction(leaves: Leaves, params: UpDirectionParams) -> UpDirection:
    """Tells up by the ground, on which several leaves come to stand and none goes below (ours)."""
    if params.up is not None:
        return UpDirection(up=params.up, confidence=1.0)
    found = direction(leaves.positions)
    return UpDirection(up=DIRECTIONS[found.direction], confidence=found.confidence)
