"""What the loom itself costs: planning, doing nothing again, and seconds per node outside the numerics.

    python benchmarks/overhead.py [--nodes 10000] [--frames 500]

Prints one table. Toy tasks of no cost are planned and run, so that all the time there is belongs to the loom.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

CHAIN = '''
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
'''


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--nodes", type=int, default=10_000, help="nodes of the planned graph")
    options.add_argument("--frames", type=int, default=500, help="frames of the run that does nothing")
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = (*_toy(Path(folder), chosen.nodes), *_shell(Path(folder), chosen.frames), *_share(Path(folder)))
        for row in rows:
            print(f"{row[0]:<64}{row[1]:>12}")


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
        told = pipeline(executor, frames, executor).run()
        spent = time.perf_counter() - started
        each = 1000 * spent / told["nodes"]["ran"]
        yield f"{executor}: {told['nodes']['ran']} nodes that compute nothing and store 13,000×3", f"{each:.1f} ms each"
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


def _share(folder: Path, frames: int = 16) -> Iterator[tuple[str, str]]:
    """A run of the real graph at 13,000 vertices a frame against the same functions called one after the other."""
    from kinetree.pipeline import Pipeline
    from kinetree.tasks import METHODS

    synth = {"figure": "human", "frames": frames, "vertices": 13_000}
    config = {"output": str(folder / "share"), "source": {"synth": synth}, "compute": {"executor": "sync"}}
    pipeline = Pipeline.of(config)
    params, tasks = pipeline.config.params, METHODS["mesoscopic"].by_name
    given = [pipeline.artifact("source", frame=t) for t in range(frames)]

    def plainly() -> None:
        made: dict[str, list[object]] = {"source": given}
        for task in (t for t in METHODS["mesoscopic"].tasks if not t.is_origin):
            told = {"params": params[task.name]} if task.params else {}
            reads = [(a, made[next(n for n, t in tasks.items() if t.returns is a.artifact)]) for a in task.arguments]
            rows = range(frames) if task.over else range(1)
            made[task.name] = [task(**{a.name: _read(a.form, found, t) for a, found in reads}, **told) for t in rows]

    plainly()  # compiles, or loads what was compiled
    started = time.perf_counter()
    plainly()
    alone = time.perf_counter() - started
    started = time.perf_counter()
    pipeline.run()
    spent = time.perf_counter() - started
    yield f"real graph, {frames} frames of 13,000 vertices, one thread: functions alone", f"{alone:.2f} s"
    yield "the same as a run, with keys, store and records", f"{spent:.2f} s"
    yield "share of the run that is not numerics", f"{100 * (1 - alone / spent):.1f} %"


def _read(form: str, found: list[object], t: int) -> object:
    if form == "one":
        return found[t] if len(found) > 1 else found[0]
    return dict(enumerate(found)) if form == "mapping" else tuple(found)


if __name__ == "__main__":
    main()
