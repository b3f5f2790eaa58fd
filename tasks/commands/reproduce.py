"""`kinetree reproduce`: the tables and figures of the 2014 paper, by its preset and by the default."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from kinetree.errors import ConfigError
from kinetree.pipeline.command_line.options import AsJson, Set, err, out, print_json
from kinetree.pipeline.command_line.printable import printable

if TYPE_CHECKING:
    from kinetree.tasks.reproduction.sequence import Sequence
    from kinetree.tasks.reproduction.table import Table

PAPERS = ("2014",)
TABLES = (1, 2)
FIGURES = (11, 19, 20, 21)


def reproduce(
    paper: Annotated[str, typer.Argument(metavar="PAPER", help="The paper by its year: 2014.")],
    table: Annotated[
        list[int] | None, typer.Option("--table", help="1: seconds a frame; 2: errors of joints. May be repeated.")
    ] = None,
    figure: Annotated[
        list[int] | None,
        typer.Option("--figure", help="11: areas by threshold; 19, 20: both methods side by side; 21: noise. May be repeated."),
    ] = None,
    source: Annotated[
        Path | None,
        typer.Option(
            "--input",
            "-i",
            metavar="FOLDER",
            help="Your own sequence; default: a generated body, as in kinetree demo.",
            show_default=False,
        ),
    ] = None,
    truth: Annotated[
        Path | None, typer.Option("--truth", metavar="FILE", help="The true skeleton; default: the generated body's.")
    ] = None,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for results and runs.")] = Path("kinetree-reproduce"),
    sets: Set = None,
    as_json: AsJson = False,
) -> None:
    """Make the tables and figures of the 2014 paper, by its preset and by the default.

    Computes the sequence with both methods and prints their figures beside the paper's. All tables and figures are made
    unless some are named. Parameters that are set hold for both methods.
    """
    if paper not in PAPERS:
        raise ConfigError(f"{paper}: no such paper; tables and figures are made of {', '.join(PAPERS)}")
    tables, figures = _chosen(table, TABLES, "--table"), _chosen(figure, FIGURES, "--figure")
    if not tables + figures:
        tables, figures = TABLES, FIGURES
    from kinetree.tasks.reproduction.sequence import Sequence

    sequence = Sequence(output, source, truth, tuple(sets or ()), lambda text: err.print(printable(text), markup=False))
    written, files = _written(sequence, tables, figures)
    if as_json:
        print_json({"tables": [one.json() for one in written], "files": [str(path) for path in files]})
        return
    for one in written:
        _print(one)
    for path in files:
        out.print(printable(path), markup=False)


def _chosen(numbers: list[int] | None, known: tuple[int, ...], option: str) -> tuple[int, ...]:
    """The numbers that were asked for, each once; raises ConfigError for one that is not made."""
    for number in numbers or ():
        if number not in known:
            raise ConfigError(f"{option} {number}: not made; there are {', '.join(map(str, known))}")
    return tuple(n for n in known if n in (numbers or ()))


def _written(sequence: "Sequence", tables: tuple[int, ...], figures: tuple[int, ...]) -> "tuple[list[Table], list[Path]]":
    """Makes and writes what was asked for; the tables, those of figures among them, and all files."""
    from kinetree.tasks.reproduction import comparison, cost, joints, noise, thresholds
    from kinetree.tasks.results.plots.drawing import write_figure

    tabled = {1: cost.table_1, 2: joints.table_2}
    drawn = {11: thresholds.figure_11, 19: comparison.figure_19, 20: comparison.figure_20, 21: noise.figure_21}
    written = [tabled[number](sequence) for number in tables]
    files = [table.write(sequence.output) for table in written]
    for number in figures:
        picture, table = drawn[number](sequence)
        path = sequence.output / f"{table.name}.png"
        write_figure(picture, path)
        written.append(table)
        files += [path, table.write(sequence.output)]
    return written, files


def _print(table: "Table") -> None:
    """Prints a table with its title above and its notes below."""
    from rich.table import Table as Printed

    printed = Printed(box=None, pad_edge=False, header_style="bold", title=table.title, title_justify="left")
    for i, name in enumerate(table.columns):
        printed.add_column(escape(name), justify="right" if any(isinstance(r[i], int | float) for r in table.rows) else "left")
    for row in table.cells():
        printed.add_row(*(escape(printable(cell)) for cell in row))
    out.print(printed)
    for note in table.notes:
        out.print(printable(note), markup=False)
