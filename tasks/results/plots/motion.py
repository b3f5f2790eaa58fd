"""The angle of every joint over time."""

from typing import TYPE_CHECKING

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, blank

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = 4
"""Small pictures beside one another."""
LOW_CONFIDENCE = 0.5
"""Confidence below which the angle is drawn bold."""


def angles(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Angle of every joint against its parent since the reference pose, one picture a joint."""
    skeleton: Skeleton = fetch("skeleton")
    turning = [j for j, kind in enumerate(skeleton.kinds) if kind == "joint"]
    if not turning:
        figure, axes = blank(6.0, 1.2)
        axes.annotate("no joints", (0.5, 0.5), xycoords="axes fraction", ha="center")
        axes.set_axis_off()
        return figure
    rows = -(-len(turning) // COLUMNS)
    figure, grid = blank(11.0, 1.5 * rows + 0.6, columns=COLUMNS, rows=rows)
    angle = joint_angles(skeleton)
    highest = 1.05 * max(float(angle[:, turning].max()), 1.0)
    for k, axes in enumerate(np.ravel(grid)):
        if k >= len(turning):
            axes.set_axis_off()
            continue
        j = turning[k]
        axes.plot(skeleton.frames, angle[:, j], color=COLOURS[0], lw=1)
        unreliable = np.where(skeleton.confidence[:, j] < LOW_CONFIDENCE, angle[:, j], np.nan)
        axes.plot(skeleton.frames, unreliable, color=COLOURS[1], lw=2.2)
        axes.set_title(skeleton.names[j], fontsize=8)
        axes.set(ylim=(0, highest))
        axes.tick_params(labelsize=7, labelbottom=k + COLUMNS >= len(turning), labelleft=k % COLUMNS == 0)
    figure.supylabel("angle, °", fontsize=8)
    figure.supxlabel("frame", fontsize=8)
    return figure


def joint_angles(skeleton: Skeleton) -> Floats:
    """Angle by which each joint has turned against its parent since the reference pose.

    returns : (frame, joint) degrees; 0 for the root
    """
    parent = np.array(skeleton.parents)
    above = np.where(parent < 0, np.arange(len(parent)), parent)
    trace = np.einsum("tjxy,tjxy->tj", skeleton.rotation[:, above], skeleton.rotation)
    return np.asarray(np.degrees(np.arccos(np.clip((trace - 1) / 2, -1, 1))), dtype=np.float64)
