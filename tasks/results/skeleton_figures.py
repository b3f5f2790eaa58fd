"""The body with its skeleton, drawn for the report."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.schemas.results.skeleton_figures import SkeletonFigures
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.page.alternatives import skeleton_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.structure import skeleton as skeleton_figure


@task()
def skeleton_figures(skeleton: Skeleton, excerpt: Excerpt, up_direction: UpDirection) -> SkeletonFigures:
    """Draws parts and skeleton in some frames (2014, Fig. 15)."""
    figure = skeleton_figure(lambda _: skeleton, list(excerpt.pictured), up_direction.axis)
    caption = "Parts and skeleton; white where the surface is not rigid."
    return SkeletonFigures(**rendered_figures([CaptionedFigure(figure, caption, skeleton_words(skeleton, excerpt.pictured))]))
