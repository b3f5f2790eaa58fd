"""The joints over time, drawn for the report."""

from typing import Any

from kinetree.pipeline.task import task
from kinetree.schemas.results.motion_figures import MotionFigures
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.names import readable_names
from kinetree.tasks.results.page.alternatives import angles_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.motion import angles, joint_angles


@task()
def motion_figures(skeleton: Skeleton, joint_names: JointNames) -> MotionFigures:
    """Draws the angles of joints (ours)."""

    def fetch(name: str) -> Any:
        return joint_names if name == "joint_names" else skeleton

    figure = CaptionedFigure(
        angles(fetch, []),
        "Angle of every joint since the reference pose, left and right together; with a sign (±), positive forwards, where"
        " a joint turns about one axis.",
        angles_words(skeleton, readable_names(joint_names), joint_angles(skeleton)),
    )
    return MotionFigures(**rendered_figures([figure]))
