"""`kinetree compare`: two runs of the same sequence, side by side."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from kinetree.errors import ConfigError
from kinetree.pipeline.command_line.options import AsJson, out, print_json, tell
from kinetree.pipeline.command_line.printable import printable

if TYPE_CHECKING:
    from kinetree.schemas.results.comparison import Comparison
    from kinetree.tasks.compare import FinishedRun


def compare(
    run_a: Annotated[str, typer.Argument(metavar="RUN_A", help="The output folder of a finished run, or its configuration.")],
    run_b: Annotated[str, typer.Argument(metavar="RUN_B", help="Another run of the same sequence.")],
    truth: Annotated[
        Path | None,
        typer.Option(
            "--truth",
            metavar="FILE",
            help="A truth.json, a skeleton.json or a BVH; default: the truth that came with the input.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE.html", help="Write a page with both bodies playing together."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compare two runs of the same sequence: joints, errors, parameters.

    Methods, presets and parameters may differ; the frames must be the same. Where a truth is known, both are judged against
    it by the limits of RUN_A.
    """
    from kinetree.tasks.compare import both, compared
    from kinetree.tasks.views.results import comparison_files

    _check_name(output)
    a, b = both(run_a, run_b)
    comparison = compared(a, b, truth, tell)
    if as_json:
        print_json(json.loads(comparison_files(comparison, ())["comparison.json"]))
    else:
        _print(comparison)
    if output is not None:
        _write_page(output, a, b, comparison)
        if not as_json:
            out.print(printable(output), markup=False)


def _check_name(output: Path | None) -> None:
    if output is not None and output.suffix.lower() not in (".html", ".htm"):
        raise ConfigError(f"--output {output}: the comparison is a page; name a file that ends in .html")


def _write_page(output: Path, a: "FinishedRun", b: "FinishedRun", comparison: "Comparison") -> None:
    """Writes the page, complete or not at all; raises StoreError where it cannot be written."""
    from kinetree.pipeline.storage.place import Folder
    from kinetree.tasks.compare import scenes
    from kinetree.tasks.results.page.comparison import comparison_document

    text = comparison_document(comparison, (a.skeleton, b.skeleton), scenes(a, b))
    Folder(output.parent, "output folder", beside="").put(output.name, text.encode())


def _print(comparison: "Comparison") -> None:
    """Prints the figures of both runs, the parameters that differ, and what else there is to say."""
    from kinetree.tasks.views.results import comparison_remarks, comparison_rows

    a, b = f"A: {comparison.a.name}", f"B: {comparison.b.name}"
    out.print(_table(("", a, b), comparison_rows(comparison)))
    if comparison.parameters:
        rows = [(p.key, "–" if p.a is None else p.a, "–" if p.b is None else p.b) for p in comparison.parameters]
        out.print(_table(("parameter", "A", "B"), rows))
    else:
        out.print("no parameter differs")
    for line in comparison_remarks(comparison):
        out.print(printable(line), markup=False)


def _table(head: tuple[str, str, str], rows: list[tuple[str, str, str]]) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in head:
        table.add_column(escape(printable(name)), overflow="fold")
    for row in rows:
        table.add_row(*(escape(printable(cell)) for cell in row))
    return table
