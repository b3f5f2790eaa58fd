"""Joints that are found, and their error, on surfaces with noise (2014, Fig. 21)."""

from typing import TYPE_CHECKING

from kinetree.errors import InputError, NodesFailedError
from kinetree.tasks.reproduction.joints import evaluation
from kinetree.tasks.reproduction.printed import HEIGHT
from kinetree.tasks.reproduction.sequence import PRESETS, Sequence
from kinetree.tasks.reproduction.table import Cell, Table
from kinetree.tasks.results.plots.drawing import COLOURS, blank

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIGMAS = (0.0, 1.0, 2.0)
"""Standard deviation of the noise along the normals, mm on a body of 1,500 mm; the paper has 1."""
COLUMNS = ("σ mm", "σ % of height", "method", "true joints", "found", "spurious", "error %")


def figure_21(sequence: Sequence) -> "tuple[Figure, Table]":
    """Found joints and their mean error over the noise, a line for each method; raises InputError for a given sequence."""
    if sequence.input is not None:
        raise InputError(
            f"{sequence.input}: Figure 21 adds noise to the generated body; leave out --input, or write a noisy sequence"
            " with kinetree synth --noise and ask for --table 2"
        )
    rows = [
        (sigma, 100 * sigma / HEIGHT, preset, *_measured(sequence, preset, sigma)) for preset in PRESETS for sigma in SIGMAS
    ]
    notes = ("noise along the normals; scored are true joints that turn; the paper draws σ = 1 and gives no figures",)
    return _drawn(rows), Table("figure-21", "Figure 21: joints found on noisy surfaces", COLUMNS, tuple(rows), notes)


def _measured(sequence: Sequence, preset: str, sigma: float) -> tuple[Cell, ...]:
    """True joints, found, spurious and the mean error in % of the height; none where the method fails on the noise."""
    change, beside = (f"source.synth.noise={sigma / HEIGHT:.6f}",), f"-noise-{sigma:g}"
    try:
        run = sequence.run(preset, *change, beside=beside) if sigma else sequence.run(preset)
    except NodesFailedError as error:
        sequence.tell(str(error))
        return None, None, None, None
    summary = evaluation(run).summary
    return (summary.scored, summary.found, summary.spurious, summary.percent) if summary else (None, None, None, None)


def _drawn(rows: "list[tuple[Cell, ...]]") -> "Figure":
    figure, (left, right) = blank(8.4, 3.4, 2)
    for preset, colour in zip(PRESETS, COLOURS, strict=False):
        mine = [row for row in rows if row[2] == preset]
        for axes, column in ((left, 4), (right, 6)):
            values = [float("nan") if row[column] is None else row[column] for row in mine]
            axes.plot([row[0] for row in mine], values, marker="o", ms=4, color=colour, label=preset)
    scored = max((row[3] for row in rows if isinstance(row[3], int)), default=0)
    left.axhline(scored, color="0.6", lw=0.8, ls="--")
    left.set(xlabel="σ, mm on a body of 1,500 mm", ylabel=f"joints found, of {scored}", ylim=(0, None))
    right.set(xlabel="σ, mm on a body of 1,500 mm", ylabel="mean error of these, % of the height", ylim=(0, None))
    left.legend(fontsize=8)
    return figure
