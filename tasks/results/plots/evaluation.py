"""The error of every joint, frame by frame (2014, Fig. 16)."""

from typing import TYPE_CHECKING

import numpy as np

from kinetree.errors import ConfigError
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.tasks.results.formats.colours import VERMILION
from kinetree.tasks.results.plots.drawing import COLOURS, Fetch, blank
from kinetree.tasks.results.plots.style import heading
from kinetree.tasks.results.plots.timeline import frame_rate, over_time
from kinetree.tasks.views.results import evaluation_remarks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LINE_STYLES = ("-", "--", ":", "-.")


def evaluation(fetch: Fetch, frames: list[int], up: int = 1) -> "Figure":
    """Error of every scored joint over time with its mean and deviation; below, the two measures of 2009."""
    stored = fetch("evaluation")
    if stored.summary is None:
        raise ConfigError("plot 'errors': this run has no truth; compare it with one: kinetree evaluate RUN TRUTH --plot FILE")
    return evaluation_figure(stored, frame_rate(fetch))


def evaluation_figure(evaluation: Evaluation, fps: float | None) -> "Figure":
    """The figure of one evaluation that has a truth.

    fps : frames a second; None where it is not known
    """
    figure, axes = blank(11.0, 7.5, columns=2, rows=2)
    (over, beside), (below, unused) = axes
    scored = [j for j, row in enumerate(evaluation.joints) if row.scored]
    scored.sort(key=lambda j: -(evaluation.joints[j].percent or np.inf))
    share = evaluation.error / max(evaluation.height, 1e-300) * 100.0
    for k, j in enumerate(scored):
        style = {"color": COLOURS[k % len(COLOURS)], "ls": LINE_STYLES[k // len(COLOURS) % len(LINE_STYLES)]}
        if evaluation.joints[j].found is not None:
            over.plot(evaluation.frames, share[:, j], lw=1.1, label=evaluation.joints[j].name, **style)
            bar = {"fmt": "o", "ms": 4, "capsize": 2, "color": style["color"]}
            beside.errorbar(evaluation.joints[j].percent, k, xerr=share[:, j].std(), **bar)
        else:
            beside.annotate(" missing", (0.0, k), fontsize=7, va="center", color=VERMILION)
    over.set(ylabel="error / height, %", ylim=(0, None))
    over_time(over, evaluation.frames, fps, label=False)
    heading(over, _title(evaluation))
    names = [f"{evaluation.joints[j].name}  {_length(evaluation, j)}" for j in scored]
    beside.set(yticks=range(len(scored)), xlim=(0, None), xlabel="mean ± deviation, % of the height")
    beside.set_yticklabels(names, fontsize=7)
    beside.set_ylim(max(len(scored), 1) - 0.5, -0.5)
    below.plot(evaluation.frames, evaluation.detection, color=COLOURS[0], lw=1.1, label="R_detection (2009, Eq. 8)")
    below.plot(evaluation.frames, evaluation.distance, color=COLOURS[1], lw=1.1, label="E_dist / height (2009, Eq. 9)")
    below.set(ylim=(0, 1.05))
    over_time(below, evaluation.frames, fps, both=False)
    below.legend(fontsize=7, loc="center right")
    unused.set_axis_off()
    handles, labels = over.get_legend_handles_labels()
    unused.legend(handles, labels, fontsize=7, ncols=2, loc="upper left", frameon=False)
    return figure


def _title(evaluation: Evaluation) -> str:
    """The first remark."""
    return evaluation_remarks(evaluation)[0] if evaluation.summary is not None else "no truth"


def _length(evaluation: Evaluation, j: int) -> str:
    """Mean and deviation in the sequence's unit, as 2014, Table 2 has them."""
    row = evaluation.joints[j]
    return "" if row.mean is None else f"{row.mean:.3g} ± {row.deviation:.2g}{f' {evaluation.unit}' if evaluation.unit else ''}"
