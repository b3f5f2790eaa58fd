"""What joints were found from: cones and annuli, merge errors, the graph of parts, bones' lengths (2014, Figs. 7, 11, 15)."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import to_rgb

from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.structure.traces import Traces
from kinetree.tasks.results.plots.drawing import BEHIND, COLOURS, Fetch, blank, graded, surface, view
from kinetree.tasks.results.plots.structure import bones, part_colours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NO_CONES = "no cones: no leaf is seen on the reference mesh"


def cones(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Every cone in a colour of its own, its annuli in turn lighter and darker, from both sides.

    Pale where cones overlap, dark where there is none.
    """
    found, traced = fetch("skeleton"), fetch("traces")
    V, axis = found.vertices, view([found.vertices], up)
    figure, row = blank(8.0, 4.8, 2)
    colour = _ring_colours(traced, found.faces)
    for axes, turn, side in zip(row, (axis, axis * [-1, 1, -1]), ("one side", "the other"), strict=True):
        X = V @ turn
        surface(axes, X, found.faces, colour)
        for k, tip in enumerate(traced.tips):
            axes.plot(*X[tip, :2], "o", color="white", mec="black", mew=1.0, ms=6, zorder=4)
            axes.annotate(f"{k}", X[tip, :2], xytext=(5, 5), textcoords="offset points", fontsize=8, bbox=BEHIND)
        axes.set_title(side if len(traced.tips) else NO_CONES, fontsize=9)
    return figure


def merging(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Merge error along each cone from its tip inwards, the threshold, the first cut, and the parts that are left."""
    found, traced = fetch("skeleton"), fetch("traces")
    count = len(traced.tips)
    if not count:
        return _told(NO_CONES)
    columns = min(count, 3)
    rows = -(-count // columns)
    figure, grid = blank(3.6 * columns, 2.3 * rows + 0.6, columns, rows)
    every = np.atleast_1d(grid).ravel()
    for axes in every[count:]:
        axes.set_axis_off()
    highest = 100 * max(float(np.nanmax(traced.merge, initial=0.0)), 2 * traced.threshold)
    shown = np.flatnonzero((traced.run >= 0).any(axis=0))
    for k, axes in enumerate(every[:count]):
        _merged(axes, found, traced, k)
        axes.set(xlim=(0, shown.max(initial=0) + 1), ylim=(0, 1.3 * highest))
        axes.set_title(f"cone {k}", fontsize=9, pad=3)
    figure.supxlabel("annulus, from the tip inwards", fontsize=9)
    figure.supylabel("merge error, % of the root of the area", fontsize=9)
    figure.legend(*every[0].get_legend_handles_labels(), loc="outside upper center", ncols=4, fontsize=8, frameon=False)
    return figure


def structure(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Left, all parts that meet, by how far their joint drifts; right, the tree that is left."""
    found, traced = fetch("skeleton"), fetch("traces")
    axis = view([found.vertices], up)
    figure, (before, after) = blank(10.4, 5.4, 2)
    pale = np.full((len(found.faces), 4), 0.93)
    for axes, colour in ((before, pale), (after, part_colours(found))):
        surface(axes, found.vertices @ axis, found.faces, colour)
    drift = 100 * traced.drift / float(np.linalg.norm(np.ptp(found.vertices, axis=0)))
    shade = graded(float(drift.max(initial=1e-3)))
    _graph(before, traced, traced.middle @ axis, traced.rest @ axis, shade.to_rgba(drift))
    bar = figure.colorbar(shade, ax=before, shrink=0.7, location="left", pad=0.0)
    bar.set_label("what its two parts disagree by on a joint, % of the body's diagonal", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    dropped = int((traced.joint < 0).sum())
    before.set_title(f"{len(traced.joint)} parts, {len(traced.pair)} borders; dotted: not in the spanning tree", fontsize=9)
    bones(after, found, found.rest @ axis)
    gone = (traced.rest @ axis)[_lost(traced)]
    after.plot(*gone[:, :2].T, "x", color="black", ms=7, mew=1.8, zorder=6)
    joints = found.kinds.count("joint")
    after.set_title(f"{joints} joints left; crossed: {len(gone)} that are none ({dropped} parts dropped)", fontsize=9)
    return figure


def lengths(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """By what every bone's length varies over the sequence as the parts alone carry its ends; held lengths vary by 0."""
    found, traced = fetch("skeleton"), fetch("traces")
    row = [j for j, parent in enumerate(found.parents) if parent >= 0]
    if not row:
        return _told("no bones: the body is one rigid part")
    figure, axes = blank(7.0, max(2.2, 0.2 * len(row) + 1.3))
    colour = [COLOURS[0] if found.kinds[j] == "leaf" else COLOURS[1] for j in row]
    axes.barh(range(len(row)), traced.variation[row], color=colour)
    unit = f" {found.unit}" if found.unit else ""
    for place, j in enumerate(row):
        told = f" {traced.length[j]:.3g} ± {traced.deviation[j]:.2g}{unit}"
        axes.annotate(told, (traced.variation[j], place), va="center", fontsize=6.5)
    axes.set(ylim=(len(row) - 0.4, -0.6), yticks=range(len(row)), xlim=(0, 1.35 * max(float(traced.variation.max()), 1e-6)))
    axes.set_yticklabels([found.names[j] for j in row], fontsize=7)
    axes.tick_params(axis="x", labelsize=7)
    axes.set_title("Bones to joints (orange) and to their ends (blue): mean length and its deviation", fontsize=9)
    axes.set_xlabel("standard deviation of the bone's length before it is held, % of its mean; 0 after", fontsize=8)
    return figure


def _told(words: str) -> "Figure":
    """A figure that says why there is nothing to see."""
    figure, axes = blank(5.0, 1.0)
    axes.set_axis_off()
    axes.text(0.5, 0.5, words, ha="center", va="center", fontsize=10)
    return figure


def _ring_colours(traced: Traces, F: Ints) -> Floats:
    """(face, 4) colour of the one cone that a face is in, in turn lighter and darker by annulus."""
    within = np.asarray((traced.ring[:, F] >= 0).all(axis=2))
    several = within.sum(axis=0)
    colour: Floats = np.ones((len(F), 4))
    colour[:, :3] = np.where(several > 1, 0.88, 0.45)[:, None]
    for k, inside in enumerate(within):
        mine = inside & (several == 1)
        light = 0.1 + 0.55 * (traced.ring[k][F[mine]].min(axis=1) % 2)[:, None]
        colour[mine, :3] = (1 - light) * np.array(to_rgb(COLOURS[k % 6])) + light
    return colour


def _merged(axes: "Axes", found: Skeleton, traced: Traces, k: int) -> None:
    """One cone: the curve, the threshold, first cuts as ticks below, parts as bands."""
    rings = int((traced.run[k] >= 0).sum())
    part, run = traced.joint_of_annulus[k, :rings], traced.run[k, :rings]
    at = np.arange(1, rings + 1)
    edges = [0, *(np.flatnonzero(np.diff(part)) + 1).tolist(), rings]
    word: Any = {"transform": _over(axes), "ha": "center", "va": "top", "fontsize": 6, "rotation": 90}
    for number, (a, b) in enumerate(pairwise(edges)):
        if b > a and part[a] >= 0:
            axes.axvspan(a, b, color=COLOURS[5] if number % 2 else COLOURS[4], alpha=0.28, lw=0)
            if b - a >= 3:
                axes.text((a + b) / 2, 0.97, found.names[int(part[a])], **word)
    cut = np.flatnonzero(np.diff(run)) + 1
    axes.vlines(edges[1:-1], 0, 1, transform=_over(axes), color="black", lw=0.8, label="border of parts")
    axes.vlines(cut, 0, 0.1, transform=_over(axes), color=COLOURS[3], lw=1.2, label="first cut")
    axes.plot(at, 100 * traced.merge[k, :rings], color=COLOURS[0], lw=1.4, label="merge error")
    axes.axhline(100 * traced.threshold, color=COLOURS[1], lw=1.0, ls="--", label="threshold")
    axes.tick_params(labelsize=7)


def _over(axes: "Axes") -> Any:
    """Across in data, up in shares of the axes."""
    return axes.get_xaxis_transform()


def _lost(traced: Traces) -> Any:
    """(border,) whether a border is a joint no longer: not in the tree, or of a part that was dropped."""
    dropped = traced.joint < 0
    return ~traced.kept | dropped[traced.pair].any(axis=1) if len(traced.pair) else np.zeros(0, np.bool_)


def _graph(axes: "Axes", traced: Traces, middle: Floats, rest: Floats, colour: Floats) -> None:
    """Parts as squares, crossed where they were dropped; borders as lines over their joints, dotted outside the tree."""
    for row, (a, b) in enumerate(traced.pair):
        way = np.stack([middle[a], rest[row], middle[b]])
        axes.plot(*way[:, :2].T, "-" if traced.kept[row] else ":", color=colour[row], lw=2.2, zorder=3)
        axes.plot(*rest[row, :2], "o", color=colour[row], mec="white", mew=0.4, ms=5, zorder=4)
    gone = traced.joint < 0
    axes.plot(*middle[~gone, :2].T, "s", color="black", ms=4, zorder=5)
    axes.plot(*middle[gone, :2].T, "X", color=COLOURS[1], mec="white", mew=0.5, ms=9, zorder=5)
