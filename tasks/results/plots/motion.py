"""The angle of every joint over time."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.joint_names import CERTAIN_FRONT, JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.turning import signed_turning, turning
from kinetree.tasks.results.formats.names import station_and_side
from kinetree.tasks.results.formats.rig import main_children
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, blank, words
from kinetree.tasks.results.plots.timeline import over_time, recognised

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_COLUMNS = 4
"""Small pictures beside one another."""
LOW_CONFIDENCE = 0.5
"""Confidence below which an angle is drawn over a band."""
LOOK = {"left": (COLOURS[0], "-"), "right": (COLOURS[1], "--"), "": ("black", "-")}
"""Colour and line of the sides."""


class Panel(NamedTuple):
    """Joints of one place of the body, left and right together; their angles are signed or not.

    joints : by side: left, right, or empty
    """

    name: str
    joints: dict[str, int]
    is_signed: bool


def angles(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Angle of every joint against its parent since the reference pose, left and right of one place in one picture."""
    skeleton: Skeleton = fetch("skeleton")
    names = recognised(fetch)
    total, signed = joint_angles(skeleton), signed_angles(skeleton, names)
    drawn_panels = panels(skeleton, names, signed)
    if not drawn_panels:
        return words("no joints")
    columns = columns_of(len(drawn_panels))
    rows = -(-len(drawn_panels) // columns)
    figure, grid = blank(2.75 * columns, 1.6 * rows + 0.8, columns=columns, rows=rows)
    cells = np.ravel(grid)
    for axes in cells[len(drawn_panels) :]:
        axes.remove()
    drawn = [(signed if panel.is_signed else total)[:, list(panel.joints.values())] for panel in drawn_panels]
    low, high = min(0.0, *(float(a.min()) for a in drawn)), max(1.0, *(float(a.max()) for a in drawn))
    for k, (axes, panel) in enumerate(zip(cells, drawn_panels, strict=False)):
        _angle(axes, skeleton, panel, signed if panel.is_signed else total)
        margin = 0.05 * (high - low)
        axes.set(
            ylim=(low - margin, high + margin), xlim=(skeleton.frames[0], max(skeleton.frames[-1], skeleton.frames[0] + 1))
        )
        over_time(axes, skeleton.frames, skeleton.fps, both=False, label=False)
        axes.tick_params(labelsize=7, labelbottom=k + columns >= len(drawn_panels), labelleft=k % columns == 0)
    figure.supylabel("angle since the reference pose, °", fontsize=8)
    figure.supxlabel("time, s" if skeleton.fps else "frame", fontsize=8)
    _legend(figure, drawn_panels, skeleton)
    return figure


def columns_of(count: int) -> int:
    """Columns of a grid with the fewest empty cells, at most `MOST_COLUMNS` and one less; of those the widest grid."""
    return count if count < MOST_COLUMNS else min((MOST_COLUMNS, MOST_COLUMNS - 1), key=lambda c: -count % c)


def panels(skeleton: Skeleton, names: JointNames | None, signed: Floats) -> list[Panel]:
    """One for every place of the body that has a joint, in the order of the joints."""
    places: dict[str, dict[str, int]] = {}
    for j, kind in enumerate(skeleton.kinds):
        if kind == "joint":
            station, side = station_and_side(names.anatomy[j]) if names and names.anatomy[j] else (skeleton.names[j], "")
            station = f"{station} ({skeleton.names[j]})" if side in places.get(station, {}) else station
            places.setdefault(station, {})[side] = j
    return [Panel(name, joints, bool(np.isfinite(signed[:, list(joints.values())]).all())) for name, joints in places.items()]


def joint_angles(skeleton: Skeleton) -> Floats:
    """Angle by which each joint has turned against its parent since the reference pose.

    returns : (frame, joint) degrees; 0 for the root
    """
    w = turning(np.array(skeleton.rotation), skeleton.parents)
    return np.asarray(np.degrees(np.linalg.norm(w, axis=2)), dtype=np.float64)


def signed_angles(skeleton: Skeleton, names: JointNames | None) -> Floats:
    """The same with a sign, positive forwards; NaN where it has none, as everywhere where the front is not certain.

    returns : (frame, joint) degrees
    """
    w = turning(np.array(skeleton.rotation), skeleton.parents)
    if names is None or names.front_confidence < CERTAIN_FRONT:
        return np.full(w.shape[:2], np.nan)
    rest = np.array(skeleton.rest)
    bone = rest[list(main_children(rest, skeleton.parents))] - rest
    return np.asarray(np.degrees(signed_turning(w, bone, np.array(names.front))), dtype=np.float64)


def _angle(axes: "Axes", skeleton: Skeleton, panel: Panel, angle: Floats) -> None:
    """One place of the body."""
    for side, j in panel.joints.items():
        colour, line = LOOK[side]
        unreliable = np.where(skeleton.confidence[:, j] < LOW_CONFIDENCE, angle[:, j], np.nan)
        axes.plot(skeleton.frames, unreliable, color=colour, lw=6, alpha=0.3, solid_capstyle="round")
        axes.plot(skeleton.frames, angle[:, j], line, color=colour, lw=1.2)
    if panel.is_signed:
        axes.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    axes.set_title(f"{panel.name} ±" if panel.is_signed else panel.name, fontsize=8, pad=3)


def _legend(figure: "Figure", panels: list[Panel], skeleton: Skeleton) -> None:
    """Names the sides, the sign and the bands where there are any."""
    from matplotlib.lines import Line2D

    sides = {side for panel in panels for side in panel.joints} - {""}
    entries = [Line2D([], [], color=LOOK[s][0], ls=LOOK[s][1], lw=1.2, label=s) for s in LOOK if s in sides]
    joints = [j for panel in panels for j in panel.joints.values()]
    if (skeleton.confidence[:, joints] < LOW_CONFIDENCE).any():
        entries.append(Line2D([], [], color="0.5", lw=6, alpha=0.3, label=f"confidence below {LOW_CONFIDENCE}"))
    if any(panel.is_signed for panel in panels):
        entries.append(Line2D([], [], color="none", label="± signed: positive forwards; else the whole angle"))
    if entries:
        figure.legend(handles=entries, loc="outside upper center", ncols=len(entries), fontsize=8, frameon=False)
