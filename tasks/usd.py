"""The body as film and simulation programs take it."""

from kinetree.pipeline.task import task
from kinetree.schemas.skeleton import Skeleton
from kinetree.schemas.usd import Usd, UsdParams
from kinetree.tasks.exports.usd import usd as written


@task(on_request=True)
def usd(skeleton: Skeleton, params: UsdParams) -> Usd:
    """Writes skeleton.usda, the reference mesh skinned to the animated skeleton (ours)."""
    return Usd.of({"skeleton.usda": written(skeleton, params)})
