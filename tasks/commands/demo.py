"""`kinetree demo`: a synthetic walk through the whole graph, from generated frames to the report."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from kinetree.pipeline.command_line.commands import compute_and_report
from kinetree.pipeline.command_line.options import out, pipeline_of
from kinetree.pipeline.command_line.printable import printable


def demo(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the results.")] = Path("kinetree-demo"),
) -> None:
    """Compute an example and say where the results are.

    The example is generated: 36 frames of a walking human of 3,000 vertices, whose hand rests on its hip for a while.
    """
    compute_and_report(pipeline_of("demo", output=str(output)))
    folder = shlex.quote(str(output))
    for command, what in (
        (f"kinetree view {folder}", "the report: the body playing with parts and skeleton, curves, warnings"),
        (f"kinetree show skeleton {folder}", "the tree of joints and bones"),
        (f"kinetree evaluate {folder}", "how far every joint is from the true one"),
        ("kinetree run --input FOLDER --output OUT", "the same with your own meshes, one file per frame"),
    ):
        out.print(printable(f"  {command}  # {what}"), markup=False)
