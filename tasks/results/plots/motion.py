"""How every joint turns over time."""

from typing import TYPE_CHECKING

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, blank

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = 4


def angles(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """How far every joint has turned against its parent since the reference pose, a picture a joint."""
    found: Skeleton = fetch("skeleton")
    inner = [j for j, kind in enumerate(found.kinds) if kind == "joint"]
    if not inner:
        figure, axes = blank(6.0, 1.2)
        axes.annotate("no joints", (0.5, 0.5), xycoords="axes fraction", ha="center")
        axes.set_axis_off()
        return figure
    rows = -(-len(inner) // COLUMNS)
    figure, grid = blank(11.0, 1.5 * rows + 0.6, columns=COLUMNS, rows=rows)
    turned = turns(found)
    highest = 1.05 * max(float(turned[:, inner].max()), 1.0)
    for k, axes in enumerate(np.ravel(grid)):
        if k >= len(inner):
            axes.set_axis_off()
            continue
        j = inner[k]
        axes.plot(found.frames, turned[:, j], color=COLOURS[0], lw=1)
        doubted = np.where(found.confidence[:, j] < 0.5, turned[:, j], np.nan)
        axes.plot(found.frames, doubted, color=COLOURS[1], lw=2.2)
        axes.set_title(found.names[j], fontsize=8)
        axes.set(ylim=(0, highest))
        axes.tick_params(labelsize=7, labelbottom=k + COLUMNS >= len(inner), labelleft=k % COLUMNS == 0)
    figure.supylabel("turned by, °", fontsize=8)
    figure.supxlabel("frame", fontsize=8)
    return figure


def turns(found: Skeleton) -> Floats:
    """(frame, joint) degrees by which each joint has turned against its parent since the reference pose; 0 for the root."""
    parent = np.array(found.parents)
    above = np.where(parent < 0, np.arange(len(parent)), parent)
    trace = np.einsum("tjxy,tjxy->tj", found.rotation[:, above], found.rotation)
    return np.asarray(np.degrees(np.arccos(np.clip((trace - 1) / 2, -1, 1))), dtype=np.float64)
