"""How far the aligned mesh is from every frame, over time and on the surface (2014, Fig. 6)."""

from typing import TYPE_CHECKING

import numpy as np

from kinetree.tasks.plots.drawing import COLOURS, Fetch, levels, surface, view

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def alignment(fetch: Fetch, frames: list[int], up: int | None = None) -> "Figure":
    """Distance of the aligned mesh to every frame over time; below, on the surface of some frames, in % of its size."""
    reference = fetch("reference")
    every = [fetch("alignment", frame=frame) for frame in reference.frames]
    off = np.stack([np.asarray(a.residual) for a in every]) / reference.size * 100
    from matplotlib.figure import Figure

    figure = Figure(figsize=(max(9.0, 3.0 * len(frames)), 8.0), layout="constrained")
    rows = figure.add_gridspec(3, len(frames))
    axes, below = figure.add_subplot(rows[0, :]), figure.add_subplot(rows[1, :])
    t = np.array(reference.frames)
    for name, q, style in (("median", 0.5, "-"), ("95 % of vertices below", 0.95, "--"), ("largest", 1.0, ":")):
        axes.plot(t, np.quantile(off, q, axis=1), style, label=name, color=COLOURS[0] if q == 0.5 else "black", lw=1)
    axes.axvline(reference.frame, color=COLOURS[1], lw=1)
    axes.annotate("reference", (reference.frame, 0.9), xycoords=("data", "axes fraction"), fontsize=7, color=COLOURS[1])
    axes.set(ylabel="distance, % of size", ylim=(0, None), title="Distance of the aligned mesh to every frame")
    axes.legend(fontsize=7, ncols=3)
    below.plot(t, [100 * a.uncovered for a in every], color=COLOURS[1], lw=1, label="of the frame not explained")
    doubted = [100 * (1 - float(np.mean(a.trust))) for a in every]
    below.plot(t, doubted, "--", color="black", lw=1, label="of the body not trusted")
    below.set(xlabel="frame", ylabel="%", ylim=(0, None))
    below.legend(fontsize=7, ncols=2)
    axis = view([fetch("alignment", frame=frame).vertices for frame in frames], up)
    highest = float(np.quantile(off, 0.995)) or 1.0
    for column, frame in enumerate(frames):
        body = figure.add_subplot(rows[2, column])
        found = fetch("alignment", frame=frame)
        colour = levels(reference.faces, np.asarray(found.residual) / reference.size * 100, 0.0, highest)
        surface(body, found.vertices @ axis, reference.faces, colour)
        body.set_title(f"frame {frame}, yellow from {highest:.2g} %", fontsize=8)
    return figure


