"""Distance of the aligned mesh from every frame, over time and on the surface (2014, Fig. 6)."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, graded, levels, same_scale, surface, view
from kinetree.tasks.results.plots.style import heading
from kinetree.tasks.results.plots.timeline import over_time

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def reference_frame(skeleton: Skeleton, alignments: Mapping[int, Alignment]) -> int:
    """The source frame number at which the aligned mesh is the reference mesh, or nearest to it.

    alignments : by source frame number
    """
    return min(skeleton.frames, key=lambda f: float(np.abs(alignments[f].vertices - skeleton.vertices).max()))


def alignment(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Distance of the aligned mesh from every frame over time, and on the surface of some frames, % of the root of the area."""
    body = fetch("skeleton")
    alignments = {frame: fetch("alignment", frame=frame) for frame in body.frames}
    size = _size(body)
    residual = np.stack([np.asarray(a.residual) for a in alignments.values()]) / size * 100
    from matplotlib.figure import Figure

    figure = Figure(figsize=(max(9.0, 3.0 * len(frames)), 8.0), layout="constrained")
    rows = figure.add_gridspec(3, len(frames))
    axes, below = figure.add_subplot(rows[0, :]), figure.add_subplot(rows[1, :])
    t = np.array(body.frames)
    for name, q, style in (("median", 0.5, "-"), ("95 % of the vertices below", 0.95, "--"), ("largest", 1.0, ":")):
        axes.plot(t, np.quantile(residual, q, axis=1), style, label=name, color=COLOURS[0] if q == 0.5 else "black", lw=1)
    reference = reference_frame(body, alignments)
    axes.axvline(reference, color=COLOURS[1], lw=1)
    axes.annotate("reference", (reference, 0.9), xycoords=("data", "axes fraction"), fontsize=7, color=COLOURS[1])
    axes.set(
        ylabel="distance, % of √area",
        ylim=(0, None),
    )
    heading(axes, "Distance of the aligned mesh from every frame")
    over_time(axes, body.frames, body.fps, label=False)
    axes.legend(fontsize=7, ncols=3)
    below.plot(
        t,
        [100 * a.uncovered for a in alignments.values()],
        color=COLOURS[1],
        lw=1,
        label="surface of the frame that is uncovered",
    )
    unreliable = [100 * (1 - float(np.mean(a.confidence))) for a in alignments.values()]
    below.plot(t, unreliable, "--", color="black", lw=1, label="body that is unreliable")
    below.set(ylabel="%", ylim=(0, None))
    over_time(below, body.frames, body.fps, both=False)
    below.legend(fontsize=7, ncols=2)
    axis = view([alignments[frame].vertices for frame in frames], up)
    highest = float(np.quantile(residual, 0.995)) or 1.0
    panels = [figure.add_subplot(rows[2, column]) for column in range(len(frames))]
    for panel, frame in zip(panels, frames, strict=True):
        aligned = alignments[frame]
        colour = levels(body.faces, np.asarray(aligned.residual) / size * 100, 0.0, highest)
        surface(panel, aligned.vertices @ axis, body.faces, colour)
        panel.set_title(f"frame {frame}", fontsize=8)
    same_scale(panels)
    bar = figure.colorbar(graded(highest), ax=panels, shrink=0.8, extend="max", pad=0.0)
    bar.set_label("distance, % of √area", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    return figure


def _size(body: Skeleton) -> float:
    """Root of the area of the reference mesh, mesh unit."""
    a, b, c = np.array(body.vertices)[body.faces].transpose(1, 0, 2)
    return float(np.sqrt(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2))
