"""The steps of the 2009 paper: graphs inside the body, coherent intervals, clusters, the structure (Figs. 1 to 4, 6)."""

from typing import TYPE_CHECKING, Any

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, blank, graded, same_scale, surface, view
from kinetree.tasks.results.plots.style import heading
from kinetree.tasks.results.plots.timeline import frame_rate, over_time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PALE = 0.93


def endoskeleton(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Left, the Reeb graph at the resolution with which the replacement begins; right, the graph inside the body (Fig. 1)."""
    model = fetch("integrated_structure")
    graph, inner = fetch("reeb_graph", frame=model.frame), fetch("perg", frame=model.frame)
    axis = view([model.vertices], up)
    figure, (before, after) = blank(9.0, 5.0, 2)
    level = min(2, int(graph.level.max()))
    own = np.arange(int((graph.level == 0).sum()))
    for _ in range(level):
        own = graph.parent[own]
    for axes in (before, after):
        surface(axes, model.vertices @ axis, model.faces, np.full((len(model.faces), 4), PALE))
    edge = np.unique(own[graph.edge], axis=0)
    _drawn(before, graph.centre @ axis, edge[edge[:, 0] != edge[:, 1]], COLOURS[1])
    before.set_title(f"Reeb graph in {2 ** (int(graph.level.max()) - level)} bands", fontsize=9)
    _drawn(after, inner.node @ axis, inner.edge, COLOURS[0])
    after.set_title(f"inside the body: {len(inner.node)} nodes, {inner.replaced} replaced by finer ones", fontsize=9)
    return figure


def coherence(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Ends and loops of every frame's graph over time, coherent intervals shaded (Sec. 2.2)."""
    runs = fetch("coherent_intervals")
    figure, axes = blank(8.0, 2.6)
    for a, b in zip(runs.begin, runs.end, strict=True):
        axes.axvspan(runs.frames[a] - 0.5, runs.frames[b] + 0.5, color=COLOURS[2], alpha=0.2, lw=0)
    axes.step(runs.frames, runs.ends, where="mid", color=COLOURS[0], label="ends")
    axes.step(runs.frames, runs.loops, where="mid", color=COLOURS[1], label="loops")
    axes.axhline(runs.wanted_ends, color=COLOURS[0], lw=0.8, ls=":")
    axes.set(ylim=(-0.3, max(int(runs.ends.max(initial=1)), runs.wanted_ends) + 1))
    over_time(axes, runs.frames, frame_rate(fetch))
    branches = ", ".join(str(list(d)) for d in runs.wanted_branches) or "none"
    heading(axes, f"shaded: coherent; {runs.wanted_ends} ends, branch degrees {branches}")
    axes.legend(fontsize=8, frameon=False, loc="upper right", ncols=2)
    return figure


def clusters(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Left, r(i, j) of neighbouring nodes; right, the clusters that move as one rigid body (Eq. 5, Fig. 2)."""
    model = fetch("integrated_structure")
    axis = view([model.vertices], up)
    figure, (left, right) = blank(9.6, 5.0, 2)
    X, child = model.node @ axis, np.flatnonzero(model.parents >= 0)
    for axes in (left, right):
        surface(axes, model.vertices @ axis, model.faces, np.full((len(model.faces), 4), PALE))
    shade = graded(1.0)
    for n in child:
        ends = X[[n, model.parents[n]]]
        left.plot(*ends[:, :2].T, color=shade.to_rgba(max(float(model.correlation[n]), 0.0)), lw=2.5, zorder=3)
        same = model.cluster[n] == model.cluster[model.parents[n]]
        right.plot(*ends[:, :2].T, color="0.3" if same else "0.75", lw=1.0, zorder=3)
    bar = figure.colorbar(shade, ax=left, shrink=0.7, location="left", pad=0.0)
    bar.set_label("r(i, j)", fontsize=8)
    colours = [COLOURS[int(c) % len(COLOURS)] for c in model.cluster]
    right.scatter(X[:, 0], X[:, 1], c=colours, s=22, zorder=4, edgecolors="black", linewidths=0.4)
    right.set_title(f"{len(np.unique(model.cluster))} clusters", fontsize=9)
    return figure


def description(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """The structure in some frames, over each frame's mesh (Figs. 4, 6)."""
    model = fetch("integrated_structure")
    posed = [(fetch("mesh", frame=frame), fetch("graph_motion", frame=frame), frame) for frame in frames]
    axis = view([mesh.vertices for mesh, _, _ in posed], up)
    figure, row = blank(3.0 * len(posed), 4.4, len(posed))
    child = np.flatnonzero(model.parents >= 0)
    edge = np.stack([model.parents[child], child], axis=1)
    for axes, (mesh, motion, frame) in zip(np.atleast_1d(row), posed, strict=True):
        surface(axes, mesh.vertices @ axis, mesh.faces, np.full((len(mesh.faces), 4), PALE))
        _drawn(axes, motion.position @ axis, edge, COLOURS[0])
        axes.set_title(f"frame {frame}", fontsize=9)
    same_scale(figure.axes)
    return figure


def _drawn(axes: "Axes", X: Floats, edge: Any, colour: Any) -> None:
    """A graph of nodes and edges."""
    for a, b in edge.tolist():
        axes.plot(X[[a, b], 0], X[[a, b], 1], color="0.25", lw=1.0, zorder=3)
    used = np.unique(edge) if len(edge) else np.arange(min(len(X), 1))
    axes.plot(X[used, 0], X[used, 1], "o", color=colour, mec="black", mew=0.4, ms=4, zorder=4)
