"""`kinetree evaluate`: how good a run's skeleton is against the truth."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from kinetree.errors import ConfigError
from kinetree.pipeline.command_line.options import AsJson, Set, out, pipeline_of, print_json, tell
from kinetree.pipeline.command_line.printable import printable

if TYPE_CHECKING:
    from kinetree.schemas.results.evaluation import Evaluation, JointScore, Summary


def evaluate(
    run: Annotated[str, typer.Argument(metavar="RUN", help="A configuration or the output folder of a run.")],
    truth: Annotated[
        Path | None,
        typer.Argument(
            metavar="TRUTH",
            help="A truth.json, a skeleton.json or a BVH; default: the truth that came with the run's input.",
            show_default=False,
        ),
    ] = None,
    body: Annotated[
        Path | None, typer.Option("--body", help="An npz of the true body with skinning weights, for the true parts.")
    ] = None,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE", help="Draw every joint's error over time.")] = None,
    sets: Set = None,
    as_json: AsJson = False,
) -> None:
    """Compare the skeleton of a run with the true one, joint by joint.

    Says how far every joint is from the true one, which joints are missing and which are spurious. Frames are compared by
    their numbers in the source. Nothing but the comparison is computed.
    """
    from kinetree.tasks.results.plots.drawing import FORMATS, write_figure
    from kinetree.tasks.results.plots.evaluation import evaluation_figure
    from kinetree.tasks.views.results import evaluation_files

    if plot is not None and plot.suffix.lower() not in FORMATS:
        raise ConfigError(f"--plot {plot}: pictures end in {', '.join(FORMATS)}")
    evaluation = evaluated(run, truth, body, sets)
    if plot is not None:
        write_figure(evaluation_figure(evaluation, None), plot)
    if as_json:
        print_json(json.loads(evaluation_files(evaluation, ())["evaluation.json"]))
        return
    _print(evaluation)
    if plot is not None:
        out.print(printable(plot), markup=False)


def evaluated(run: str, truth: Path | None, body: Path | None = None, sets: list[str] | None = None) -> "Evaluation":
    """The comparison of a run with a truth; raises InputError where they are not of the same sequence."""
    from kinetree.tasks.compare import evaluated as of_pipeline

    paths = {"truth.file": truth, "truth.body": body}
    changes = [f"{key}={json.dumps(str(path.absolute()))}" for key, path in paths.items() if path is not None]
    evaluation = of_pipeline(pipeline_of(run, sets=[*(sets or ()), *changes]), tell)
    if evaluation is None:
        raise ConfigError(f"{run}: its input came without a true skeleton; name one, e.g. kinetree evaluate {run} truth.json")
    return evaluation


def _print(evaluation: "Evaluation") -> None:
    """Prints one line a joint, then the summary."""
    unit = evaluation.unit or "length"
    from kinetree.pipeline.views import remarks

    table = Table(box=None, pad_edge=False, header_style="bold")
    for name, is_left in (("joint", True), ("range", False), ("found as", True), (unit, False), ("±", False), ("%", False)):
        table.add_column(name, justify="left" if is_left else "right", overflow="fold")
    for row in sorted(evaluation.joints, key=lambda j: (j.kind == "tip", not j.scored)):
        if row.scored or row.kind == "tip" or row.found is not None:
            table.add_row(*(escape(printable(cell)) for cell in _cells(row)))
    out.print(table)
    for line in remarks(evaluation):
        out.print(printable(line), markup=False)
    if evaluation.spurious:
        of = zip(evaluation.spurious, evaluation.duplicate_of, strict=True)
        spurious = ", ".join(f"{name} (a second {true})" if true else name for name, true in of)
        out.print(printable(f"spurious: {spurious}"), markup=False)
    if evaluation.summary is not None:
        for line in _lines(evaluation.summary):
            out.print(printable(line), markup=False)


def _cells(row: "JointScore") -> list[str]:
    """The cells of one joint in the table."""
    turns = "" if row.turns is None or row.kind == "tip" else f"{row.turns:.0f}°"
    name = row.name if row.scored or row.kind == "tip" else f"{row.name} (not scored)"
    if row.found is None:
        near = "" if row.nearest is None else f"missing; the nearest joint is {row.nearest:.1f} % away"
        return [name, turns, near, "", "", ""]
    return [name, turns, row.found, f"{row.mean:.4g}", f"{row.deviation:.2g}", f"{row.percent:.2f}"]


def _lines(s: "Summary") -> list[str]:
    """The summary in words."""
    lines = [
        f"found closely: {s.close} of {s.scored}; found but not scored: {s.excused}",
        f"tips found: {s.tips_found} of {s.tips}" + ("" if s.tip_percent is None else f", mean error {s.tip_percent:.2f} %"),
        f"spurious: {s.branch_duplicates} beside a joint of several bones, {s.duplicates} beside another, {s.false} elsewhere",
        f"R_detection {s.detection:.2f}, E_dist {s.distance:.4f} of the height (2009, Eqs. 7–9)",
        f"tree edit distance {s.tree_edit}, of the shape alone {s.tree_shape}",
    ]
    measures = (("all true joints", s.chamfer, s.overlap), ("moving true joints", s.chamfer_moving, s.overlap_moving))
    for name, c, o in measures:
        lines.append(
            f"against {name}: CD-J2J {c.j2j:.2f}, CD-J2B {c.j2b:.2f}, CD-B2B {c.b2b:.2f} ×10⁻²;"
            f" IoU {o.iou:.1f} %, precision {o.precision:.1f} %, recall {o.recall:.1f} %"
        )
    if s.parts is not None:
        p = s.parts
        agreement = f"Rand {p.rand:.3f}, adjusted {p.adjusted_rand:.3f}, mean IoU {p.mean_iou:.3f}"
        lines.append(f"parts: {p.parts} found, {p.true_parts} true; {agreement}")
    relative = "" if s.jitter is None else f", {s.jitter:.2f} times that of the truth"
    lines.append(f"bone lengths vary by {s.length_variation:.2g} %")
    lines.append(f"jitter {s.jitter_percent:.3f} % of the height a frame²{relative}")
    return lines
