"""How far the aligned mesh is from every frame, over time and on the surface (2014, Fig. 6)."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, levels, surface, view

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def at_rest(skeleton: Skeleton, aligned: Mapping[int, Alignment]) -> int:
    """The frame in which the body is the reference mesh, or nearest to it."""
    return min(skeleton.frames, key=lambda f: float(np.abs(aligned[f].vertices - skeleton.vertices).max()))


def alignment(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Distance of the aligned mesh to every frame over time; below, on the surface of some frames, in % of its size."""
    body = fetch("skeleton")
    every = {frame: fetch("alignment", frame=frame) for frame in body.frames}
    size = _size(body)
    off = np.stack([np.asarray(a.residual) for a in every.values()]) / size * 100
    from matplotlib.figure import Figure

    figure = Figure(figsize=(max(9.0, 3.0 * len(frames)), 8.0), layout="constrained")
    rows = figure.add_gridspec(3, len(frames))
    axes, below = figure.add_subplot(rows[0, :]), figure.add_subplot(rows[1, :])
    t = np.array(body.frames)
    for name, q, style in (("median", 0.5, "-"), ("95 % of vertices below", 0.95, "--"), ("largest", 1.0, ":")):
        axes.plot(t, np.quantile(off, q, axis=1), style, label=name, color=COLOURS[0] if q == 0.5 else "black", lw=1)
    rest = at_rest(body, every)
    axes.axvline(rest, color=COLOURS[1], lw=1)
    axes.annotate("reference", (rest, 0.9), xycoords=("data", "axes fraction"), fontsize=7, color=COLOURS[1])
    axes.set(ylabel="distance, % of size", ylim=(0, None), title="Distance of the aligned mesh to every frame")
    axes.legend(fontsize=7, ncols=3)
    below.plot(t, [100 * a.uncovered for a in every.values()], color=COLOURS[1], lw=1, label="of the frame not explained")
    doubted = [100 * (1 - float(np.mean(a.trust))) for a in every.values()]
    below.plot(t, doubted, "--", color="black", lw=1, label="of the body not trusted")
    below.set(xlabel="frame", ylabel="%", ylim=(0, None))
    below.legend(fontsize=7, ncols=2)
    axis = view([every[frame].vertices for frame in frames], up)
    highest = float(np.quantile(off, 0.995)) or 1.0
    for column, frame in enumerate(frames):
        panel = figure.add_subplot(rows[2, column])
        found = every[frame]
        colour = levels(body.faces, np.asarray(found.residual) / size * 100, 0.0, highest)
        surface(panel, found.vertices @ axis, body.faces, colour)
        panel.set_title(f"frame {frame}, yellow from {highest:.2g} %", fontsize=8)
    return figure


def _size(body: Skeleton) -> float:
    """Root of the area of the reference mesh, mesh unit."""
    a, b, c = np.array(body.vertices)[body.faces].transpose(1, 0, 2)
    return float(np.sqrt(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2))
