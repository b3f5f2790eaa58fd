"""The joints over time, drawn for the report."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.results.motion_figures import MotionFigures
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.names import readable_names
from kinetree.tasks.results.page.alternatives import angles_words, confidence_words, tree_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.motion import angles, joint_angles
from kinetree.tasks.results.plots.structure import confidence, tree


@task()
def motion_figures(skeleton: Skeleton, joint_names: JointNames) -> MotionFigures:
    """Draws the tree of joints, their confidence and their angles (ours)."""

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
        CaptionedFigure(
            angles(fetch, []),
            "Angle of every joint since the reference pose, left and right together; with a sign (±), positive forwards, where"
            " a joint turns about one axis.",
            angles_words(skeleton, labels, joint_angles(skeleton)),
        ),
    ]
    return MotionFigures(**rendered_figures(figures))
