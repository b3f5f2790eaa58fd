"""The tree of joints and their confidence, drawn for the report."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.results.tree_figures import TreeFigures
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.names import readable_names
from kinetree.tasks.results.page.alternatives import confidence_words, tree_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.structure import confidence, tree


@task()
def tree_figures(skeleton: Skeleton, joint_names: JointNames) -> TreeFigures:
    """Draws the tree of joints and their confidence (ours)."""

    def fetch(name: str) -> Any:
        return joint_names if name == "joint_names" else skeleton

    labels = readable_names(joint_names)
    figures = [
        CaptionedFigure(
            tree(fetch, []),
            "The tree of joints with bone lengths and the range of every joint's angle.",
            tree_words(skeleton, labels),
        ),
        CaptionedFigure(
            confidence(fetch, []),
            "Confidence of every joint over time, and the drift of every joint: the distance between its two parts.",
            confidence_words(skeleton, labels),
        ),
    ]
    return TreeFigures(**rendered_figures(figures))
