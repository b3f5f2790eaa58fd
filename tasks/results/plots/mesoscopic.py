"""Cones and annuli, their merge-errors, the areas they become, bones and redundant ones (2014, Figs. 7, 11, 13 and 15)."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgba

from kinetree.schemas.array import Floats, Ints
from kinetree.tasks.results.formats.colours import GREY
from kinetree.tasks.results.plots.drawing import COLOURS, LABEL_BOX, Fetch, blank, graded, surface, view
from kinetree.tasks.results.plots.structure import bones, part_colours
from kinetree.tasks.results.plots.style import heading

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ANNULUS_COLOURS = COLOURS[:6]
BEYOND, WHITE = to_rgba(GREY), to_rgba("white")
"""Of surface beyond a cone, seen on a light and on a dark page; and of surface that is not rigid."""


def cones(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """The annuli of every cone on the reference of the interval of the first frame, grey where a cone does not reach.

    White circles are leaves (2014, Fig. 7). The last picture is of the areas that they become: white is not rigid (Fig. 13).
    """
    consistent, areas = fetch("cone_consistency"), fetch("cylinders")
    interval = _interval(fetch, frames[0])
    here, model = fetch("interval_reference", interval=interval), fetch("interval_reference", interval=areas.interval)
    annulus = consistent.annulus[:, consistent.rows(interval)]
    count = len(annulus) + 1
    columns = min(count, 4)
    figure, grid = blank(3.0 * columns, 4.4 * -(-count // columns), columns, -(-count // columns))
    every = np.atleast_1d(grid).ravel()
    for axes in every[count:]:
        axes.remove()
    axis = view([here.vertices], up)
    for cone, axes in enumerate(every[: count - 1]):
        surface(axes, here.vertices @ axis, here.faces, _shades(annulus[cone], here.faces, BEYOND))
        leaf = consistent.leaf[interval, cone]
        if leaf >= 0 and here.leaf_vertex[leaf] >= 0:
            axes.plot(*(here.vertices[here.leaf_vertex[leaf]] @ axis)[:2], "o", ms=6, color="white", mec="black", mew=0.8)
        axes.set_title(f"cone {cone}: {int(annulus[cone].max()) + 1} annuli{'' if leaf >= 0 else ', recovered'}", fontsize=9)
    label = np.where(areas.rigid[areas.label], areas.label, -1)
    surface(every[count - 1], model.vertices @ axis, model.faces, _shades(label, model.faces, WHITE))
    every[count - 1].set_title(f"areas, interval {areas.interval}", fontsize=9)
    return figure


def merging(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Merge-error along every cone with the threshold, in the interval of the first frame; clusters by threshold (Fig. 11)."""
    consistent, integrated = fetch("cone_consistency"), fetch("integration")
    interval = _interval(fetch, frames[0])
    count = len(consistent.annulus)
    figure, columns = blank(9.0, 1.5 * (count + 1.6), rows=count + 1)
    every = np.atleast_1d(columns)
    thresholds = np.zeros(0)
    for cone, axes in enumerate(every[:-1]):
        annuli = fetch("annuli", interval=interval, cone=cone)
        thresholds = annuli.theta
        rung = int(np.argmin(np.abs(annuli.theta - integrated.theta)))
        colour = [COLOURS[0] if rigid else COLOURS[1] for rigid in annuli.rigid[rung]]
        axes.bar(annuli.annulus, annuli.merge_error[rung], color=colour, width=0.8)
        axes.axhline(integrated.theta, color="black", lw=0.8, ls="--")
        for k in np.flatnonzero(~integrated.rigid[cone, : int(annuli.annulus.max(initial=-1)) + 1]):
            axes.axvspan(k - 0.5, k + 0.5, color=COLOURS[1], alpha=0.12, lw=0)
        axes.set(ylabel=f"cone {cone}", xlim=(-0.7, integrated.rigid.shape[1] - 0.3))
    heading(every[0], f"Merge-error in interval {interval}; orange: joint here, shaded: joint in some interval, dashed: θ_r")
    if len(thresholds):
        every[-1].plot(thresholds, integrated.clusters, color="black", marker=".", lw=1)
        every[-1].axvline(integrated.theta, color="black", lw=0.8, ls="--")
    every[-1].set(xlabel="threshold θ_r (above: annulus, 0 at the leaf)", ylabel="rigid areas", ylim=(0, None))
    return figure


def structure(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Left, joints by the number of their area and all bones by how their length varies; right, the tree (2014, Fig. 15)."""
    areas, links, skeleton = fetch("cylinders"), fetch("bones"), fetch("skeleton")
    model = fetch("interval_reference", interval=areas.interval)
    axis = view([model.vertices], up)
    figure, (before, after) = blank(10.4, 5.4, 2)
    pale = np.full((len(model.faces), 4), 0.93)
    for axes, colour in ((before, pale), (after, part_colours(skeleton))):
        surface(axes, model.vertices @ axis, model.faces, colour)
    X = links.centroid[links.frames.index(model.frame)] @ axis
    percent = 100 * links.variation / model.size
    shade = graded(float(percent[np.isfinite(percent)].max(initial=1e-3)))
    for (i, j), in_tree, variation in zip(links.bone, links.in_tree, percent, strict=True):
        before.plot(*X[[i, j], :2].T, "-" if in_tree else ":", color=shade.to_rgba(variation), lw=2.2, zorder=3)
    for area in np.flatnonzero(~areas.rigid):
        before.plot(*X[area, :2], "o", color=COLOURS[1], mec="white", mew=0.4, ms=5, zorder=4)
        before.annotate(str(area), X[area, :2], xytext=(4, 3), textcoords="offset points", fontsize=7, bbox=LABEL_BOX)
    bar = figure.colorbar(shade, ax=before, shrink=0.7, location="left", pad=0.0)
    bar.set_label("standard deviation of a bone's length, % of the root of the area", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    count, redundant = int((~areas.rigid).sum()), int((~links.in_tree).sum())
    heading(before, f"{count} non-rigid areas, {len(links.bone)} bones; dotted: {redundant} redundant")
    bones(after, skeleton, skeleton.rest @ axis)
    after.set_title(f"{skeleton.kinds.count('joint')} joints", fontsize=9)
    return figure


def lengths(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Variation of the length of every bone between two areas before lengths are fixed; redundant bones are hollow."""
    links = fetch("bones")
    measured = np.flatnonzero(np.isfinite(links.variation))
    figure, axes = blank(7.0, max(2.2, 0.2 * len(measured) + 1.3))
    if not len(measured):
        axes.set_axis_off()
        axes.text(0.5, 0.5, "no bones between joints", ha="center", va="center", fontsize=10)
        return figure
    ends = links.centroid[:, links.bone[measured]]
    mean = np.nanmean(np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2), axis=0)
    percent = 100 * links.variation[measured] / np.maximum(mean, 1e-300)
    in_tree = links.in_tree[measured]
    axes.barh(range(len(measured)), percent, color=np.where(in_tree, COLOURS[0], "white"), edgecolor=COLOURS[0])
    axes.set(ylim=(len(measured) - 0.4, -0.6), yticks=range(len(measured)))
    axes.set_yticklabels([f"{i} – {j}" for i, j in links.bone[measured].tolist()], fontsize=7)
    axes.set_xlabel("standard deviation of the bone's length before it is fixed, % of its mean", fontsize=8)
    heading(axes, "Bones between areas; hollow: redundant")
    return figure


def _interval(fetch: Fetch, frame: int) -> int:
    """The interval in which a frame is."""
    cuts = fetch("intervals")
    return int(np.searchsorted(cuts.end, cuts.frames.index(frame)))


def _shades(label: Ints, F: Ints, rest: tuple[float, float, float, float]) -> Floats:
    """(face, 4) a colour for each label in turn; `rest` for a face of which a corner has no label."""
    corners = label[F]
    least = corners.min(axis=1)
    palette = np.array([to_rgba(c) for c in ANNULUS_COLOURS])
    colour: Floats = palette[np.maximum(least, 0) % len(palette)]
    colour[least < 0] = rest
    return colour
