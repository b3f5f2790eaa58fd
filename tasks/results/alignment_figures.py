"""The alignment, drawn for the report."""

from collections.abc import Mapping
from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.results.alignment_figures import AlignmentFigures
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.alternatives import alignment_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.page.skin import skin_distance
from kinetree.tasks.results.plots.alignment import alignment as alignment_figure
from kinetree.tasks.results.plots.alignment import reference_frame


@task()
def alignment_figures(
    skeleton: Skeleton,
    excerpt: Excerpt,
    connectivity: Connectivity,
    up_direction: UpDirection,
    alignment: Mapping[int, Alignment],
) -> AlignmentFigures:
    """Draws residuals where anything was aligned, and measures how near the skin is to the aligned mesh (2014, Fig. 6)."""

    def fetch(_: str, frame: int | None = None) -> Any:
        return skeleton if frame is None else alignment[frame]

    caption = "Distance of the aligned mesh from every frame, over time and on the surface."
    reference = reference_frame(skeleton, alignment)
    figures = []
    if not connectivity.fixed:
        figure = alignment_figure(fetch, list(excerpt.pictured), up_direction.axis)
        figures = [CaptionedFigure(figure, caption, alignment_words(skeleton, alignment, reference))]
    return AlignmentFigures(
        reference=reference,
        skin_distance=skin_distance(skeleton, alignment),
        **rendered_figures(figures),
    )
