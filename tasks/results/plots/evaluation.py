"""How far every joint is from the truth, frame by frame (2014, Fig. 16)."""

from typing import TYPE_CHECKING

import numpy as np

from kinetree.errors import ConfigError
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.tasks.results.formats.colours import VERMILION
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, blank
from kinetree.tasks.views.results import evaluation_remarks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DASHES = ("-", "--", ":", "-.")


def evaluation(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Error of every scored joint over time with mean and deviation beside it; below, the two measures of 2009."""
    told = fetch("evaluation")
    if told.summary is None:
        raise ConfigError(
            "plot 'errors': nobody knows the truth of this run; kinetree evaluate RUN TRUTH --plot FILE names one"
        )
    return drawn(told)


def drawn(told: Evaluation) -> "Figure":
    """The figure of one evaluation that has a truth."""
    figure, axes = blank(11.0, 7.5, columns=2, rows=2)
    (over, beside), (below, unused) = axes
    shown = [j for j, row in enumerate(told.joints) if row.scored]
    shown.sort(key=lambda j: -(told.joints[j].percent or np.inf))
    share = told.error / max(told.height, 1e-300) * 100.0
    for k, j in enumerate(shown):
        style = {"color": COLOURS[k % len(COLOURS)], "ls": DASHES[k // len(COLOURS) % len(DASHES)]}
        if told.joints[j].found is not None:
            over.plot(told.frames, share[:, j], lw=1.1, label=told.joints[j].name, **style)
            beside.errorbar(told.joints[j].percent, k, xerr=share[:, j].std(), fmt="o", ms=4, capsize=2, color=style["color"])
        else:
            beside.annotate("missing", (0.0, k), fontsize=7, va="center", color=VERMILION)
    over.set(ylabel="error / height, %", ylim=(0, None), title=_title(told))
    names = [f"{told.joints[j].name}  {_length(told, j)}" for j in shown]
    beside.set(yticks=range(len(shown)), xlim=(0, None), xlabel="mean ± deviation over the frames, % of the height")
    beside.set_yticklabels(names, fontsize=7)
    beside.set_ylim(max(len(shown), 1) - 0.5, -0.5)
    below.plot(told.frames, told.detection, color=COLOURS[0], lw=1.1, label="R_detection (2009, Eq. 8)")
    below.plot(told.frames, told.distance, color=COLOURS[1], lw=1.1, label="E_dist / height (2009, Eq. 9)")
    below.set(xlabel="frame", ylim=(0, 1.05))
    below.legend(fontsize=7, loc="center right")
    unused.set_axis_off()
    handles, labels = over.get_legend_handles_labels()
    unused.legend(handles, labels, fontsize=7, ncols=2, loc="upper left", frameon=False)
    return figure


def _title(told: Evaluation) -> str:
    return evaluation_remarks(told)[0] if told.summary is not None else "no truth"


def _length(told: Evaluation, j: int) -> str:
    """Mean and deviation in the sequence's unit, as 2014, Table 2 has them."""
    row = told.joints[j]
    return "" if row.mean is None else f"{row.mean:.3g} ± {row.deviation:.2g}{f' {told.unit}' if told.unit else ''}"
