"""Exports the animated body as USD, for film and simulation."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.usd import Usd, UsdParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.usd import usd as usd_text


@task(on_request=True)
def usd(skeleton: Skeleton, params: UsdParams) -> Usd:
    """Writes skeleton.usda, the reference mesh skinned to the animated skeleton (ours)."""
    return Usd.of({"skeleton.usda": usd_text(skeleton, params)})
