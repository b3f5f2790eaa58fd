"""Cones and annuli, what clusters them, and the areas they become (2014, Figs. 7, 11 and 13)."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import to_rgba

from kinetree.schemas.array import Floats, Ints
from kinetree.tasks.plots.drawing import COLOURS, Fetch, blank, surface, view

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RINGS = COLOURS[:6]
BLACK, WHITE = to_rgba("0.12"), to_rgba("white")


def cones(fetch: Fetch, frames: list[int], up: int | None = None) -> "Figure":
    """The annuli of every cone on the reference of the interval of the first frame, black where a cone does not reach.

    White circles are leaves (2014, Fig. 7). The last picture is of the areas that they become: white is not rigid (Fig. 13).
    """
    whole, told = fetch("consistency"), fetch("cylinders")
    interval = _interval(fetch, frames[0])
    here, home = fetch("middle", interval=interval), fetch("middle", interval=told.interval)
    ring = whole.ring[:, whole.rows(interval)]
    figure, row = blank(3.0 * (len(ring) + 1), 4.4, len(ring) + 1)
    axis = view([here.vertices], up)
    for cone, axes in enumerate(np.atleast_1d(row)[:-1]):
        surface(axes, here.vertices @ axis, here.faces, _shades(ring[cone], here.faces, BLACK))
        leaf = whole.leaf[interval, cone]
        if leaf >= 0 and here.tip[leaf] >= 0:
            axes.plot(*(here.vertices[here.tip[leaf]] @ axis)[:2], "o", ms=6, color="white", mec="black", mew=0.8)
        count = int(ring[cone].max()) + 1
        axes.set_title(f"cone {cone}: {count} annuli{'' if leaf >= 0 else ', recovered'}", fontsize=9)
    label = np.where(told.rigid[told.label], told.label, -1)
    surface(np.atleast_1d(row)[-1], home.vertices @ axis, home.faces, _shades(label, home.faces, WHITE))
    np.atleast_1d(row)[-1].set_title(f"areas, interval {told.interval}", fontsize=9)
    return figure


def merging(fetch: Fetch, frames: list[int], up: int | None = None) -> "Figure":
    """Merge-error along every cone with the threshold, in the interval of the first frame; clusters by threshold (Fig. 11)."""
    whole, joined = fetch("consistency"), fetch("integration")
    interval = _interval(fetch, frames[0])
    count = len(whole.ring)
    figure, columns = blank(9.0, 1.5 * (count + 1.6), rows=count + 1)
    every = np.atleast_1d(columns)
    ladder = np.zeros(0)
    for cone, axes in enumerate(every[:-1]):
        told = fetch("annuli", interval=interval, cone=cone)
        ladder = told.theta
        rung = int(np.argmin(np.abs(told.theta - joined.theta)))
        colour = [COLOURS[0] if rigid else COLOURS[1] for rigid in told.rigid[rung]]
        axes.bar(told.annulus, told.merge[rung], color=colour, width=0.8)
        axes.axhline(joined.theta, color="black", lw=0.8, ls="--")
        for k in np.flatnonzero(~joined.rigid[cone, : int(told.annulus.max(initial=-1)) + 1]):
            axes.axvspan(k - 0.5, k + 0.5, color=COLOURS[1], alpha=0.12, lw=0)
        axes.set(ylabel=f"cone {cone}", xlim=(-0.7, joined.rigid.shape[1] - 0.3))
    every[0].set_title(
        f"Merge-error in interval {interval}; orange: joint here, shaded: joint in some interval, dashed: θ_r", fontsize=9
    )
    if len(ladder):
        every[-1].plot(ladder, joined.clusters, color="black", marker=".", lw=1)
        every[-1].axvline(joined.theta, color="black", lw=0.8, ls="--")
    every[-1].set(xlabel="threshold θ_r (above: annulus, 0 at the leaf)", ylabel="rigid areas", ylim=(0, None))
    return figure


def _interval(fetch: Fetch, frame: int) -> int:
    """The interval in which a frame is."""
    cuts = fetch("intervals")
    return int(np.searchsorted(cuts.end, cuts.frames.index(frame)))


def _shades(label: Ints, F: Ints, rest: tuple[float, float, float, float]) -> Floats:
    """(face, 4) a colour for each label in turn, `rest` where a face has none or lies between labels of which one is none."""
    corners = label[F]
    mine = corners.min(axis=1)
    palette = np.array([to_rgba(c) for c in RINGS])
    colour: Floats = palette[np.maximum(mine, 0) % len(palette)]
    colour[mine < 0] = rest
    return colour
