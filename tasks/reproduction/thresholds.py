"""The surface's areas at several thresholds θ_r (2014, Fig. 11)."""

from typing import TYPE_CHECKING

import numpy as np

from kinetree.schemas.paper_2014.cylinders import Cylinders
from kinetree.tasks.reproduction.sequence import Run, Sequence
from kinetree.tasks.reproduction.table import Table
from kinetree.tasks.results.plots.drawing import blank, surface, view
from kinetree.tasks.results.plots.structure import label_colours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

THRESHOLDS = (1.1, 1.2, 1.5, 2.0, 3.0)
"""θ_r that are drawn beside the one that is chosen, which gives the most rigid areas; the paper's is 1.2."""
NEEDED = ("cylinders", "up_direction")
COLUMNS = ("θ_r", "clusters of the cones", "rigid areas", "non-rigid areas", "chosen")


def figure_11(sequence: Sequence) -> "tuple[Figure, Table]":
    """Rigid areas in colours and non-rigid ones in white at every threshold, on the model mesh; their numbers."""
    chosen = float(sequence.run("paper-2014", until=NEEDED).fetch("integration").theta)
    wanted = sorted({*THRESHOLDS, chosen})
    figure, row = blank(2.6 * len(wanted), 4.4, len(wanted))
    rows = []
    for axes, theta in zip(np.atleast_1d(row), wanted, strict=True):
        run = sequence.run("paper-2014", f"annuli.thresholds=[{theta}]", until=NEEDED, beside=f"-theta-{theta}")
        areas: Cylinders = run.fetch("cylinders")
        rigid = int(areas.rigid.sum())
        rows.append((theta, int(run.fetch("integration").clusters[0]), rigid, len(areas.rigid) - rigid, _yes(theta == chosen)))
        _draw(axes, run, areas)
        axes.set_title(f"θ_r {theta}{', chosen' if theta == chosen else ''}\n{rigid} rigid areas", fontsize=9)
    notes = ("white: not rigid; chosen: the threshold with the most clusters in all cones together (2014, Fig. 11)",)
    return figure, Table("figure-11", "Figure 11: areas by threshold", COLUMNS, tuple(rows), notes)


def _draw(axes: "Axes", run: Run, areas: Cylinders) -> None:
    model = run.fetch("interval_reference", interval=areas.interval)
    axis = view([model.vertices], run.fetch("up_direction").axis)
    label = np.where(areas.rigid[areas.label], areas.label, -1)
    surface(axes, model.vertices @ axis, model.faces, label_colours(label, model.faces))


def _yes(is_so: bool) -> str:
    return "yes" if is_so else "no"
