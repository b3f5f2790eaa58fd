"""Which frames the report shows."""

from collections.abc import Mapping

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.excerpt import Excerpt, ExcerptParams
from kinetree.tasks.numerics.results.scene import evenly_spread
from kinetree.tasks.results.page.coarse import alike


@task()
def excerpt(sequence: Sequence, mesh: Mapping[int, Mesh], params: ExcerptParams) -> Excerpt:
    """Selects the frames that the report plays and pictures, evenly spread (ours)."""
    played, pictured = (
        tuple(sequence.frames[t] for t in evenly_spread(len(sequence.frames), most)) for most in (params.frames, params.views)
    )
    return Excerpt(
        frames=played,
        alike=alike({frame: mesh[frame].faces for frame in played}),
        pictured=pictured,
    )
