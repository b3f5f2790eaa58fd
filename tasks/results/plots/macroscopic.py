"""μ on the surface with the leaves, and the correlation C(t) with the cuts (2014, Sec. 4, Fig. 5)."""

from typing import TYPE_CHECKING, Any

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.tasks.results.formats.colours import BLUE, ORANGE, VERMILION
from kinetree.tasks.results.plots.drawing import COLOURS, LABEL_BOX, Fetch, blank, levels, same_scale, surface, tall, view
from kinetree.tasks.results.plots.style import heading
from kinetree.tasks.results.plots.timeline import frame_rate, over_time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def correlation(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """C(t) with cuts and their cues, intervals shaded alternately (2014, Fig. 5); below, each cue relative to its threshold."""
    series, cut, fps = fetch("correlation"), fetch("intervals"), frame_rate(fetch)
    figure, (axes, below) = blank(9.0, 6.0, rows=2)
    t = np.array(cut.frames)
    between = (t[:-1] + t[1:]) / 2
    for row, name in enumerate(cut.cue_names):
        below.plot(between, cut.strengths[row], label=name, color=COLOURS[row], lw=1, ls=("-", "--", "-.", ":")[row % 4])
    below.axhline(1.0, color="black", lw=0.6)
    below.set(ylabel="cue / its threshold", xlim=(t[0] - 0.5, t[-1] + 0.5), ylim=(0, None))
    below.legend(fontsize=7, ncols=len(cut.cue_names))
    over_time(below, cut.frames, fps, both=False)
    for number, (begin, end) in enumerate(zip(cut.begin, cut.end, strict=True)):
        axes.axvspan(t[begin] - 0.5, t[end] + 0.5, color=BLUE if number % 2 else ORANGE, alpha=0.12, lw=0)
    axes.plot(between, series.correlation, color="black", marker=".", lw=1)
    for end, cues in zip(cut.end[:-1], cut.cues, strict=True):
        axes.axvline(t[end] + 0.5, color=VERMILION, lw=1)
        axes.annotate(" + ".join(cues), (t[end] + 0.7, 0.5), xycoords=("data", "axes fraction"), fontsize=7)
    axes.set(ylabel="C(t)", xlim=(t[0] - 0.5, t[-1] + 0.5))
    count = len(cut.begin)
    over_time(axes, cut.frames, fps, label=False)
    heading(axes, f"Correlation of μ histograms; {count} interval{'s' if count > 1 else ''}")
    return figure


def mu(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """μ on the surface with the leaves, one view a frame; a leaf has the same colour in all views."""
    leaves = fetch("leaves")
    bodies = [fetch("mesh", frame=frame).vertices for frame in frames]
    axis = view(bodies, up)
    figure, row = blank(3.2 * len(frames), tall([V @ axis for V in bodies], 3.2), len(frames))
    for axes, frame in zip(np.atleast_1d(row), frames, strict=True):
        mesh, geodesics = fetch("mesh", frame=frame), fetch("geodesics", frame=frame)
        surface(axes, mesh.vertices @ axis, mesh.faces, levels(mesh.faces, geodesics.mu))
        _draw_leaves(axes, leaves, frame, axis)
        axes.set_title(f"frame {frame}", fontsize=9)
    same_scale(figure.axes)
    return figure


def _draw_leaves(axes: "Axes", leaves: Any, frame: int, axis: Floats) -> None:
    """The leaves of one frame with their numbers; hollow where the position is interpolated."""
    for leaf, (position, is_seen) in enumerate(zip(leaves.at(frame), leaves.is_seen(frame), strict=True)):
        if not np.isnan(position).any():
            x, y, _ = position @ axis
            colour = COLOURS[leaf % len(COLOURS)]
            axes.plot(x, y, "o", ms=7, color=colour if is_seen else "none", mec="white" if is_seen else colour)
            axes.annotate(
                str(leaf), (x, y), xytext=(5, 5), textcoords="offset points", fontsize=8, color=colour, bbox=LABEL_BOX
            )
