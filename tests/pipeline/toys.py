"""A toy graph with every kind of edge the loom knows, on frames that are text files with one number each.

`conftest.py` copies this file, `toy_sums.py` and `toy_passes.py` into a package with a name of its own, so that a test can
edit it. Nothing here depends on time: a task that is to fail, wait or die is told so by a file in the folder named in
TOYS_FLAGS, such as `fail-points-30` for the task `points` on the number 30. Every execution adds a line to the file named in
TOYS_LOG.
"""

import os
import signal
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np

from kinetree.errors import SourceError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.task import origin, task
from kinetree.schemas.array import Array, Artifact, Floats, Index, Ints, Location, Params, PathLike
from kinetree.schemas.dims import FRAME, VERTEX

from .toy_sums import parity, rough


class SourceParams(Params):
    """Where the numbers are."""

    input: Annotated[str, PathLike()] = ""
    """Folder of text files."""
    frames: str = ":"
    """Which of them, as start:stop:step."""


class Source(Artifact):
    """One file."""

    content: str
    """Digest of its bytes."""
    path: Annotated[str, Location()]
    """Where it lies."""


class PointsParams(Params):
    """How a number becomes points."""

    scale: float = 1.0
    """Factor."""


class Points(Artifact):
    """The number of one file, times 1, 2 and 3."""

    x: Annotated[Floats, Array("float64", VERTEX, unit="length")]
    """The points."""


class SmoothParams(Params):
    """How much is lost."""

    grain: float = 10.0
    """Multiples of this remain."""


class Smooth(Artifact):
    """The first point, roughly."""

    value: float
    """A multiple of the grain."""


class Total(Artifact):
    """All frames together."""

    value: float
    """Sum over the frames."""
    frames: tuple[int, ...]
    """Their numbers."""


class Centred(Artifact):
    """One frame seen from all of them: the second pass over the frames."""

    value: float
    """Distance to the mean."""


class IntervalsParams(Params):
    """How the frames are cut."""

    length: int = 2
    """Frames an interval."""


class Intervals(Artifact):
    """Runs of consecutive frames; how many there are depends on the data."""

    opens: ClassVar[tuple[str, ...]] = ("interval", "interval/frame")
    frames: tuple[tuple[int, ...], ...]
    """The frames of each interval."""

    def members(self, space: str, index: Index) -> tuple[int, ...]:
        """Intervals, or the frames of one."""
        return tuple(range(len(self.frames))) if space == "interval" else self.frames[index[0]]


class Cones(Artifact):
    """The cones of one interval."""

    opens: ClassVar[tuple[str, ...]] = ("interval/cone",)
    count: int
    """How many."""
    value: float
    """Sum over the interval's frames."""

    def members(self, space: str, index: Index) -> tuple[int, ...]:
        """The cones of the interval."""
        return tuple(range(self.count))


class Piece(Artifact):
    """One cone."""

    value: float
    """What it is worth."""


class Local(Artifact):
    """One frame as one interval sees it."""

    value: float
    """The frame's value over the interval's."""


class OrderParams(Params):
    """Where tracking begins."""

    reference: int = 2
    """The frame tracked first, or the one nearest to it."""


class Order(Artifact):
    """Outwards from the reference, to both sides."""

    frames: Annotated[Ints, Array("int32", FRAME)]
    """Frame numbers, ascending."""
    reference: int
    """Position of the first in `frames`."""

    def previous(self, member: int) -> int | None:
        """The neighbour towards the reference."""
        at = int(np.searchsorted(self.frames, member))
        if at == self.reference:
            return None
        return int(self.frames[at - 1 if at > self.reference else at + 1])


class Track(Artifact):
    """The way from the reference to this frame."""

    way: tuple[float, ...]
    """The values passed, the reference's first."""


class Report(Artifact):
    """The end of the graph."""

    value: float
    """Everything added up."""


def executed(name: str, number: float) -> None:
    """Notes an execution, then does what the flags ask of it."""
    call = f"{name}-{number:g}"
    with Path(os.environ["TOYS_LOG"]).open("a") as log:
        log.write(f"{call}\n")
    flags = Path(os.environ["TOYS_FLAGS"])
    if (flags / f"fail-{call}").exists():
        raise ValueError(f"{call} was told to fail")
    if (flags / f"die-{call}").exists():
        (flags / f"die-{call}").unlink()
        os.kill(os.getpid(), signal.SIGKILL)
    if (flags / f"slay-{call}").exists():
        os.kill(os.getpid(), signal.SIGKILL)
    if (flags / f"stall-{call}").exists():
        (flags / f"stall-{call}").rename(flags / f"stalled-{call}")
        while (flags / f"stalled-{call}").exists():
            threading.Event().wait(0.01)
    if (flags / f"wait-{call}").exists():
        (flags / f"waiting-{call}").write_text(str(os.getpid()))
        while (flags / f"wait-{call}").exists():
            threading.Event().wait(0.01)


@origin(over="frame")
def source(params: SourceParams, files: Files) -> Mapping[int, Source]:
    """Lists the files."""
    paths = files.complete(sorted(Path(params.input).glob("*.txt")))
    if not paths:
        raise SourceError(f"no frames in {params.input}")
    sources = [Source(content=c, path=str(p)) for c, p in zip(files.digests(paths), paths, strict=True)]
    chosen = range(len(sources))[slice(*(int(p) if p else None for p in params.frames.split(":")))]
    return {frame: sources[frame] for frame in chosen}


@task(over="frame")
def points(source: Source, params: PointsParams) -> Points:
    """Reads one number (2014, Sec. 3)."""
    number = float(Path(source.path).read_text())
    executed("points", number)
    return Points(x=params.scale * number * np.array([1.0, 2.0, 3.0]))


@task(over="frame")
def smooth(points: Points, params: SmoothParams) -> Smooth:
    """Forgets the details."""
    executed("smooth", points.x[0])
    return Smooth(value=rough(float(points.x[0]), params.grain))


@task()
def total(smooth: Mapping[int, Smooth]) -> Total:
    """Gathers all frames."""
    value = sum(s.value for s in smooth.values())
    executed("total", value)
    return Total(value=value, frames=tuple(smooth))


@task(over="frame")
def centred(smooth: Smooth, total: Total) -> Centred:
    """Looks at every frame again, knowing all of them."""
    executed("centred", smooth.value)
    return Centred(value=smooth.value - total.value / len(total.frames))


@task()
def intervals(smooth: Mapping[int, Smooth], params: IntervalsParams) -> Intervals:
    """Cuts the sequence."""
    executed("intervals", len(smooth))
    frames = tuple(smooth)
    return Intervals(frames=tuple(frames[k : k + params.length] for k in range(0, len(frames), params.length)))


@task(over="interval")
def cones(smooth: tuple[Smooth, ...]) -> Cones:
    """Counts the cones of an interval: one, and another where the tens of its sum are odd."""
    value = sum(s.value for s in smooth)
    executed("cones", value)
    return Cones(count=1 + parity(value / 10), value=value)


@task(over="interval/cone")
def piece(cones: Cones) -> Piece:
    """Weighs one cone."""
    executed("piece", cones.value)
    return Piece(value=cones.value / cones.count)


@task(over="interval/frame")
def local(smooth: Smooth, cones: Cones) -> Local:
    """Sees one frame within its interval."""
    executed("local", smooth.value)
    return Local(value=smooth.value / (1.0 + cones.value))


@task()
def order(total: Total, params: OrderParams) -> Order:
    """Puts the frames in the order in which they are tracked."""
    executed("order", len(total.frames))
    nearest = min(range(len(total.frames)), key=lambda k: abs(total.frames[k] - params.reference))
    return Order(frames=np.array(total.frames), reference=nearest)


@task(over="frame", along=Order)
def track(centred: Centred, before: "Track | None") -> Track:
    """Goes on from the neighbour."""
    executed("track", centred.value)
    return Track(way=(*(before.way if before else ()), centred.value))


@task()
def report(track: tuple[Track, ...], piece: tuple[Piece, ...], local: tuple[Local, ...]) -> Report:
    """Adds everything up."""
    value = sum(sum(t.way) for t in track) + sum(p.value for p in piece) + sum(x.value for x in local)
    executed("report", len(track))
    return Report(value=value)


TASKS = (source, points, smooth, total, centred, intervals, cones, piece, local, order, track, report)
GRAPH = Graph.of(TASKS)
