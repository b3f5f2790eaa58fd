"""`kinetree plot`: the results of a run as pictures."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetree.errors import ConfigError, KinetreeError, UnknownNodeError
from kinetree.pipeline.command_line.options import pipeline_of

if TYPE_CHECKING:
    from kinetree.tasks.results.plots.drawing import Fetch


STYLES = ("screen", "paper")
WHAT = (
    "alignment", "angles", "clusters", "coherence", "cones", "confidence", "correlation", "description", "elimination",
    "endoskeleton", "errors", "lengths", "merging", "mu", "skeleton", "structure", "tree",
)  # fmt: skip
"""What can be drawn of some method; `kinetree.tasks.results.plots` draws it, and refuses what a method does not have."""


def plot(
    run: Annotated[str, typer.Argument(metavar="RUN", help="A configuration or the output folder of a run.")],
    what: Annotated[str, typer.Argument(metavar="WHAT", help=f"One of {', '.join(WHAT)}.")],
    output: Annotated[Path | None, typer.Option("--output", "-o", help="File: .png, .svg or .pdf; default: WHAT.png.")] = None,
    frames: Annotated[
        str, typer.Option("--frames", metavar="N,N,…", help="Frames to draw, or all; default: four across the sequence.")
    ] = "",
    up: Annotated[
        str | None, typer.Option("--up", help="What points up: x, y, z, -x, -y or -z; default: as the run has it.")
    ] = None,
    style: Annotated[
        str, typer.Option("--style", help="screen, or paper: as wide as a column or a page, no headings, safe in grey.")
    ] = "screen",
) -> None:
    """Draw a result of a run: curves, surfaces, the tree, errors."""
    if style not in STYLES:
        raise ConfigError(f"--style {style}: write {' or '.join(STYLES)}")
    from kinetree.schemas.paper_2014.interval_reference import IntervalReference
    from kinetree.schemas.structure.skeleton import Skeleton
    from kinetree.tasks.results.plots import PLOTS_OF_METHOD, draw

    pipeline = pipeline_of(run)
    there = pipeline.inspect()
    known = sorted(node.at[0] for node in there.schedule.entries if node.task == "source")
    path = output or Path(f"{what}.png")
    of_method = {a.__name__: task.name for a, task in pipeline.tasks.writers.items()}
    names = {"skeleton": of_method.get(Skeleton.__name__), "interval_reference": of_method.get(IntervalReference.__name__)}

    unnamed: list[UnknownNodeError] = []

    def fetch(name: str, **index: int) -> Any:
        try:
            return there.artifact(names.get(name) or name, **index)
        except UnknownNodeError as error:
            if name == "joint_names":  # a picture is drawn without
                unnamed.append(error)
            raise

    draw(what, fetch, _wanted(frames, known), path, _axis(up, fetch), PLOTS_OF_METHOD[pipeline.config.method], style)  # type: ignore[arg-type]
    if unnamed:
        typer.echo(
            f"{unnamed[0]}: joints have the names of the store; kinetree run {pipeline.config.output} names them", err=True
        )
    typer.echo(str(path))


def _axis(up: str | None, fetch: "Fetch") -> int:
    from pydantic import ValidationError

    from kinetree.schemas.topology.up_direction import UpDirection

    if up is None:
        try:
            return int(fetch("up_direction").axis)
        except KinetreeError:  # a run that did not come so far
            return 1
    try:
        return UpDirection.model_validate({"up": up, "confidence": 1.0}).axis
    except ValidationError:
        raise ConfigError(f"--up {up}: write x, y, z, -x, -y or -z") from None


def _wanted(text: str, known: list[int]) -> list[int]:
    """The frames that a text names, all of them, or four spread over the sequence."""
    if text.strip() == "all":
        return known
    if not text:
        return sorted({known[round(i * (len(known) - 1) / 3)] for i in range(4)})
    parts = text.split(",")
    if not all(p.strip().isdigit() and int(p) in known for p in parts):
        there = f"there are {known[0]} to {known[-1]}"
        raise ConfigError(f"--frames {text}: write all, or numbers of frames such as 0,12,30; {there}")
    return [int(p) for p in parts]
