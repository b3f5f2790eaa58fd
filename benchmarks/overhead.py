"""What the loom itself costs: planning, doing nothing again, and seconds per node outside the numerics.

    python benchmarks/overhead.py [--nodes 10000] [--frames 500]
    python benchmarks/overhead.py --parts small [--beside OTHER/.venv/bin/python]

Prints one table. Toy tasks of no cost are planned and run, so that all time belongs to the loom. The part small is a whole
run of a body of 600 vertices in 6 frames, its kernels compiled before; --beside runs another version of kinetree in turn with
this one, and prints the ratio.
"""

import argparse
import contextlib
import itertools
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import unittest.mock
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kinetree.pipeline.task import Task
from kinetree.schemas.array import Artifact

PARTS = ("toy", "shell", "share", "small")
SMALL = ("--frames", "6", "--vertices", "600")
TIMES = 3
"""Runs of each kind, of which the median counts."""
CHAIN = """
from collections.abc import Mapping
from typing import Annotated
import numpy as np
from kinetree.pipeline.task import origin, task
from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import VERTEX, XYZ

class SourceParams(Params):
    count: int = 10

class Source(Artifact):
    number: int

class First(Artifact):
    x: Annotated[Floats, Array("float64", VERTEX, XYZ)]

class Second(Artifact):
    x: Annotated[Floats, Array("float64", VERTEX, XYZ)]

class Third(Artifact):
    x: Annotated[Floats, Array("float64", VERTEX, XYZ)]

class Total(Artifact):
    sum: float

@origin(over="frame")
def source(params: SourceParams, files: object) -> Mapping[int, Source]:
    return {n: Source(number=n) for n in range(params.count)}

@task(over="frame")
def first(source: Source) -> First:
    return First(x=np.full((13000, 3), float(source.number)))

@task(over="frame")
def second(first: First) -> Second:
    return Second(x=first.x)

@task(over="frame")
def third(second: Second) -> Third:
    return Third(x=second.x)

@task()
def total(third: tuple[Third, ...]) -> Total:
    return Total(sum=float(len(third)))
"""


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--nodes", type=int, default=10_000, help="nodes of the planned graph")
    options.add_argument("--frames", type=int, default=500, help="frames of the run that does nothing")
    options.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="what is measured")
    options.add_argument("--beside", metavar="PYTHON", help="the interpreter of another version, for the part small")
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        parts = {
            "toy": lambda: _toy(Path(folder), chosen.nodes),
            "shell": lambda: _shell(Path(folder), chosen.frames),
            "share": lambda: _share(Path(folder)),
            "small": lambda: _small(Path(folder), chosen.beside),
        }
        for what, *cells in itertools.chain.from_iterable(parts[part]() for part in chosen.parts):
            print(f"{what:<64}" + "".join(f"{cell:>12}" for cell in cells), flush=True)


def _toy(folder: Path, nodes: int) -> Iterator[tuple[str, str]]:
    (folder / "chain_of_three.py").write_text(CHAIN)
    sys.path.insert(0, str(folder))
    import chain_of_three as toys  # type: ignore[import-not-found]

    from kinetree.pipeline.graph import Graph
    from kinetree.pipeline.inspect import Pipeline

    graph = Graph.of((toys.source, toys.first, toys.second, toys.third, toys.total))

    def pipeline(name: str, frames: int, executor: str) -> Pipeline:
        config = {"output": str(folder / name), "source": {"count": frames}, "compute": {"executor": executor}}
        return Pipeline.of(config, methods={"mesoscopic": graph})

    started = time.perf_counter()
    plan = pipeline("planned", nodes // 3, "sync").plan()
    yield f"plan of {len(plan.nodes)} nodes, nothing stored", f"{time.perf_counter() - started:.2f} s"
    for executor in ("sync", "threads", "processes"):
        frames = 100
        started = time.perf_counter()
        ran = pipeline(executor, frames, executor).run()["nodes"]["ran"]
        spent = time.perf_counter() - started
        each = 1000 * spent / ran
        yield f"{executor}: {ran} nodes that compute nothing and store 13,000×3", f"{each:.1f} ms each"
    started = time.perf_counter()
    plan = pipeline("sync", 100, "sync").plan()
    yield f"plan of {len(plan.nodes)} nodes, all fresh", f"{time.perf_counter() - started:.2f} s"


def _shell(folder: Path, frames: int) -> Iterator[tuple[str, str]]:
    rng = np.random.default_rng(0)
    tetrahedron = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int32)
    meshes = folder / "meshes"
    meshes.mkdir()
    for t in range(frames):
        points = tetrahedron + rng.normal(scale=0.01, size=(4, 3))
        rows = ["OFF", "4 4 0", *(" ".join(map(str, p)) for p in points), *(f"3 {a} {b} {c}" for a, b, c in faces)]
        (meshes / f"frame_{t}.off").write_text("\n".join(rows) + "\n")
    command = [str(Path(sys.executable).parent / "kinetree"), "run", "--input", str(meshes), "--output", str(folder / "out")]
    for what in ("first run", "second run, computing nothing"):
        started = time.perf_counter()
        subprocess.run([*command, "--until", "mesh", "--quiet"], check=True)
        yield f"{what}, {frames} frames of 4 vertices, from the shell", f"{time.perf_counter() - started:.2f} s"


def _small(folder: Path, beside: str | None) -> Iterator[tuple[str, ...]]:
    """Processor seconds of a whole run of a small body: what a run costs besides its frames."""
    command, body = "from kinetree.tasks.application import main; main()", str(folder / "small")
    pythons = [sys.executable, *([beside] if beside else [])]
    subprocess.run([*pythons[:1], "-c", command, "synth", "human", "-o", body, *SMALL], check=True, stdout=subprocess.DEVNULL)

    def seconds(python: str, *options: str) -> float:
        output = folder / "small-out"
        shutil.rmtree(output, ignore_errors=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run = [python, "-c", command, "run", "--input", body, "--output", str(output), "--quiet", *options]
        subprocess.run(run, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    for python in pythons:
        seconds(python)  # compiles, or loads what was compiled
    spent: dict[tuple[str, int], list[float]] = {}
    for executor, workers in (("sync", 1), ("threads", 2), ("processes", 1), ("processes", 2)):
        options = ("--executor", executor, "--workers", str(workers))
        samples = [[seconds(python, *options) for python in pythons] for _ in range(TIMES)]
        spent[executor, workers] = [statistics.median(column) for column in zip(*samples, strict=True)]
        yield _compared(f"600 vertices, 6 frames, {executor}, {workers}: processor", spent[executor, workers])
    further = [two - one for one, two in zip(spent["processes", 1], spent["processes", 2], strict=True)]
    yield _compared("  of it for a further worker process", further)


def _compared(what: str, seconds: list[float]) -> tuple[str, ...]:
    """A row: seconds of each version, and how many times as many the second takes."""
    ratio = [f"{seconds[1] / seconds[0]:.2f}"] if len(seconds) > 1 else []
    return (what, *(f"{s:.1f} s" for s in seconds), *ratio)


def _share(folder: Path, frames: int = 16, vertices: int = 13_000) -> Iterator[tuple[str, str]]:
    """A run of the real graph in one thread: seconds in the tasks' functions against those of the whole run."""
    from kinetree.pipeline import Pipeline

    def pipeline(name: str, frames: int, vertices: int) -> Pipeline:
        synth = {"figure": "human", "frames": frames, "vertices": vertices}
        return Pipeline.of({"output": str(folder / name), "source": {"synth": synth}, "compute": {"executor": "sync"}})

    pipeline("compiled", 3, 1000).run()  # compiles, or loads what was compiled
    with _timed_functions() as seconds:
        started = time.perf_counter()
        pipeline("share", frames, vertices).run()
        spent = time.perf_counter() - started
    yield f"real graph, {frames} frames of {vertices:,} vertices, one thread: a run", f"{spent:.2f} s"
    yield f"of it in the functions of {len(seconds)} nodes", f"{sum(seconds):.2f} s"
    yield "share of the run that is not numerics", f"{100 * (1 - sum(seconds) / spent):.1f} %"


@contextlib.contextmanager
def _timed_functions() -> Iterator[list[float]]:
    """Notes the seconds that every task's function takes, its inputs read before."""
    seconds: list[float] = []
    plain = Task.__call__

    def timed(self: Task[..., Any], **inputs: Any) -> Any:
        for value in inputs.values():
            _read(value)
        started = time.perf_counter()
        try:
            return plain(self, **inputs)
        finally:
            seconds.append(time.perf_counter() - started)

    with unittest.mock.patch.object(Task, "__call__", timed):
        yield seconds


def _read(value: object) -> None:
    """Reads every array of an input, which are read from the store when they are asked for."""
    if isinstance(value, Artifact):
        for name in type(value).model_fields:
            getattr(value, name)
    elif isinstance(value, tuple | Mapping):
        for inner in value.values() if isinstance(value, Mapping) else value:
            _read(inner)


if __name__ == "__main__":
    main()
