"""The joints over time, drawn for the report."""

from kinetree.pipeline.task import task
from kinetree.schemas.results.motion_figures import MotionFigures
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.motion import angles
from kinetree.tasks.results.plots.structure import confidence, tree


@task()
def motion_figures(skeleton: Skeleton) -> MotionFigures:
    """Draws the tree of joints, their confidence and their angles (ours)."""

    def fetch(_: str) -> Skeleton:
        return skeleton

    figures = [
        CaptionedFigure(tree(fetch, []), "The tree of joints with bone lengths and the range of every joint's angle."),
        CaptionedFigure(
            confidence(fetch, []),
            "Confidence of every joint over time, and the drift of every joint: the distance between its two parts.",
        ),
        CaptionedFigure(
            angles(fetch, []), "Angle of every joint against the reference pose; bold where confidence is below 0.5."
        ),
    ]
    return MotionFigures(**rendered_figures(figures))
