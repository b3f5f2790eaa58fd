"""A chain long enough to travel in stretches, and frames apart; the process of a node dies where a flag tells it to."""

import os
import signal
from collections.abc import Mapping
from pathlib import Path

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import origin, task
from kinetree.schemas.array import Artifact, Params


class SourceParams(Params):
    """How long the chain is."""

    input: str = ""
    """Not read."""
    count: int = 20
    """Links."""


class Source(Artifact):
    """One frame."""

    number: int
    """Its number."""


class Row(Artifact):
    """From the first frame to the last."""

    count: int
    """Frames."""

    def previous(self, member: int) -> int | None:
        """The frame before."""
        return member - 1 if member else None


class Link(Artifact):
    """The chain up to a frame."""

    length: int
    """Links."""


class Apart(Artifact):
    """A frame by itself."""

    number: int
    """Its number."""


def executed(name: str, number: int) -> None:
    """Notes an execution; a flag slay-NAME-NUMBER ends the process, each time."""
    with Path(os.environ["TOYS_LOG"]).open("a") as log:
        log.write(f"{name}-{number}\n")
    if (Path(os.environ["TOYS_FLAGS"]) / f"slay-{name}-{number}").exists():
        os.kill(os.getpid(), signal.SIGKILL)


@origin(over="frame")
def source(params: SourceParams, files: object) -> Mapping[int, Source]:
    """So many frames."""
    return {n: Source(number=n) for n in range(params.count)}


@task()
def row(source: tuple[Source, ...]) -> Row:
    """Puts them in a row."""
    return Row(count=len(source))


@task(over="frame", along=Row)
def link(source: Source, before: "Link | None") -> Link:
    """Adds a frame to the chain."""
    executed("link", source.number)
    return Link(length=before.length + 1 if before else 1)


@task(over="frame")
def apart(source: Source) -> Apart:
    """Looks at a frame alone."""
    executed("apart", source.number)
    return Apart(number=source.number)


GRAPH = Graph.of((source, row, link, apart))
