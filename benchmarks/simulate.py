"""How a night over a data set too large to try would go: nodes, objects, requests, dollars, and what holds it up first.

    python benchmarks/simulate.py [--sequences 10000] [--length 500] [--frames 4 8] [--vertices 6000] [--loops 1 4 16]
                                  [--put 5e-6] [--get 4e-7] [--month 0.023] [--json FILE]
    python benchmarks/simulate.py --check [--frames 3 5] [--vertices 600]

Computes a generated human at two lengths, in one thread, with processor seconds on record and every question to the store
counted, and draws straight lines through what it finds: so many a sequence, so many a frame. What grows faster than the
number of frames comes out too small. A store in a bucket is asked the same questions as one in a folder: `put` and listings
are paid by `--put`, other questions by `--get`, in dollars each, and what is stored by `--month`, in dollars for 1 GB.

`--loops` is how many processes run the data set at once and share its sequences: each examines its input, lays out its
graphs and sends its parcels by itself.

`--check` holds the prediction against runs: two bodies are computed, then the same data set is run again with nodes that sleep
in proportion to what they took, on 1, 2 and 4 workers. Sleeping needs no core, so that a busy machine disturbs it little.
"""

import argparse
import json
import tempfile
import threading
import time
import unittest.mock
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from amdahl import AT_WORKER, IN_LOOP, Jobs, longest_path, makespan, recorded

from kinetree.pipeline.dataset.dataset import Dataset
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.node import Node
from kinetree.pipeline.running import execute
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.store import Store
from kinetree.pipeline.task import Task
from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.input.synth import write_sequence

QUESTIONS = {
    "put": "put", "names": "put", "listed": "put", "children": "put",
    "get": "get", "tail": "get", "part": "get", "size": "get", "modified": "get", "look": "get",
    "remove": "free",
}  # fmt: skip
"""What each question to a place is paid as."""
WORKERS = (1, 4, 16, 64, 256, 1024, 4096, 16384)
ASKED = {"put": 3500.0, "get": 5500.0}
"""Questions a second that a bucket answers below one prefix, as its makers say."""
CHECKED = (1, 2, 4)
SLEPT = 60.0
"""Seconds that all nodes of a check sleep together: long against what the loom does beside them."""


@dataclass(frozen=True)
class Units:
    """What one sequence costs, or what each further frame adds to it."""

    nodes: float
    parcels: float
    compute: float
    """Processor seconds of all nodes."""
    begin: float
    """Processor seconds in the process of the loop until its first node is sent: examining the input, laying out."""
    objects: float
    bytes: float
    put: float
    get: float
    path: float
    """Seconds of the nodes that wait for each other and take longest."""

    def plus(self, other: "Units", times: float) -> "Units":
        """These and so many of the others."""
        return Units(**{name: value + times * getattr(other, name) for name, value in asdict(self).items()})


def main() -> None:
    """Prints the tables."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--sequences", type=int, default=10_000)
    options.add_argument("--length", type=int, default=500, help="frames of each")
    options.add_argument("--frames", type=int, nargs=2, default=(4, 8), help="of the two that are computed")
    options.add_argument("--vertices", type=int, default=6000)
    options.add_argument("--loops", type=int, nargs="+", default=(1, 4, 16))
    for name, dollars in (("put", 5e-6), ("get", 4e-7), ("month", 0.023)):
        options.add_argument(f"--{name}", type=float, default=dollars, help=f"dollars; default: {dollars:g}")
    options.add_argument("--check", action="store_true")
    options.add_argument("--json", type=Path)
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if chosen.check:
            check(Path(folder), max(chosen.frames), chosen.vertices)
            return
        short, long = (measured(Path(folder) / str(n), n, chosen.vertices) for n in chosen.frames)
    apart = chosen.frames[1] - chosen.frames[0]
    frame = Units(**{name: (getattr(long, name) - value) / apart for name, value in asdict(short).items()})
    sequence = short.plus(frame, chosen.length - chosen.frames[0])
    if chosen.json:
        chosen.json.write_text(json.dumps({"frame": asdict(frame), "sequence": asdict(sequence)}, indent=1))
    _print_units(frame, sequence, chosen.sequences)
    _print_dollars(sequence, chosen)
    for loops in chosen.loops:
        _print_night(sequence, chosen.sequences, loops)


def measured(folder: Path, frames: int, vertices: int) -> Units:
    """What one generated human costs."""
    takes = folder / "takes"
    write_sequence(SynthParams(figure="human", frames=frames, vertices=vertices), takes)
    pipeline = Pipeline.of({"output": str(folder / "out"), "source": {"input": str(takes)}, "compute": {"executor": "sync"}})
    begun: list[float] = []

    def noted(*work: Any) -> Any:
        begun.append(time.process_time())
        return compute(*work)

    compute = execute.compute
    with counted() as asked, ExitStack() as patches:
        clock = SimpleNamespace(perf_counter=time.process_time)
        patches.enter_context(unittest.mock.patch.object(execute, "time", clock))
        patches.enter_context(unittest.mock.patch.object(execute, "compute", noted))
        started = time.process_time()
        told = pipeline.run()
    if told["status"] != "done":
        raise SystemExit(f"{frames} frames: {told['failures'][0]['message']}")
    jobs = recorded(pipeline, pipeline.tasks.unasked)
    store = folder / "out" / "store"
    files = [path for path in store.rglob("*") if path.is_file()]
    return Units(
        nodes=len(jobs),
        parcels=len(begun),
        compute=sum(job.seconds for job in jobs.values()),
        begin=begun[0] - started,
        objects=len(files),
        bytes=sum(path.stat().st_size for path in files),
        put=asked["put"],
        get=asked["get"],
        path=sum(job.seconds for job in longest_path(jobs)),
    )


@contextmanager
def counted() -> Iterator[Counter[str]]:
    """Counts what stores in folders are asked, by how it would be paid."""
    asked: Counter[str] = Counter()

    def counting(name: str, original: Any) -> Any:
        def ask(place: Folder, *given: Any, **named: Any) -> Any:
            if (place.root / "kinetree-store.json").exists():
                asked[QUESTIONS[name]] += 1
            return original(place, *given, **named)

        return ask

    with ExitStack() as patches:
        for name in QUESTIONS:
            if hasattr(Folder, name):
                patches.enter_context(unittest.mock.patch.object(Folder, name, counting(name, getattr(Folder, name))))
        yield asked


def bounds(sequence: Units, sequences: int, workers: int, loops: int) -> dict[str, float]:
    """Seconds by each thing that a night cannot be faster than; the longest of them is what holds it up."""
    return {
        "computing": sequences * (sequence.compute + AT_WORKER * sequence.nodes) / workers,
        "examining and laying out": sequences * sequence.begin / loops,
        "sending and hearing": sequences * IN_LOOP * sequence.nodes / loops,
        "the bucket's writes": sequences * sequence.put / ASKED["put"],
        "the bucket's reads": sequences * sequence.get / ASKED["get"],
        "one sequence's longest path": sequence.path,
    }


def _in_loop(held: Mapping[str, float]) -> dict[str, float]:
    """The bounds with all that one process does one after the other in one."""
    told = dict(held)
    told["the loop"] = told.pop("examining and laying out") + told.pop("sending and hearing")
    return told


def _print_units(frame: Units, sequence: Units, sequences: int) -> None:
    print(f"{'':<12}{'a frame more':>16}{'a sequence':>16}{'the data set':>16}")
    for name, value in asdict(sequence).items():
        print(f"{name:<12}{getattr(frame, name):>16,.4g}{value:>16,.6g}{value * sequences:>16,.4g}")


def _print_dollars(sequence: Units, chosen: argparse.Namespace) -> None:
    n = chosen.sequences
    put, get = n * sequence.put * chosen.put, n * sequence.get * chosen.get
    month = n * sequence.bytes / 1e9 * chosen.month
    print(f"\ndollars: {put:,.0f} to write and list, {get:,.0f} to read, {month:,.0f} a month to keep")


def _print_night(sequence: Units, sequences: int, loops: int) -> None:
    print(f"\n{loops} process{'es' if loops > 1 else ''} that send{'' if loops > 1 else 's'}")
    print(f"{'workers':>8}{'hours':>10}{'busy':>7}  held up by")
    alone = bounds(sequence, sequences, 1, loops)["computing"]
    for workers in WORKERS:
        held = _in_loop(bounds(sequence, sequences, workers, loops))
        what = max(held, key=held.__getitem__)
        print(f"{workers:>8}{held[what] / 3600:>10.1f}{alone / workers / held[what]:>7.0%}  {what}")


def check(folder: Path, frames: int, vertices: int) -> None:
    """Prints seconds from the first node sent to the last one done, as predicted and as they were."""
    for number, figure in enumerate(("human", "quadruped")):
        synth = {"figure": figure, "frames": frames + number, "vertices": vertices}
        write_sequence(SynthParams.model_validate(synth), folder / "takes" / f"take_{number}")
    keys: dict[str, Any] = {"sequences": f"{folder}/takes/*", "compute": {"executor": "sync"}}
    real = Dataset.of({**keys, "output": f"{folder}/real/{{name}}"}, application=APPLICATION)
    with unittest.mock.patch.object(execute, "time", SimpleNamespace(perf_counter=time.process_time)):
        told = real.run()
    if told["status"] != "done":
        failed = {name: row for name, row in told["sequences"].items() if row["state"] == "failed"}
        raise SystemExit(json.dumps(failed, indent=1))
    all_jobs: Jobs = {}
    for name in real:
        pipeline = real[name]
        jobs = recorded(pipeline, pipeline.tasks.unasked)
        own = {node: Node(f"{node.task} of {name}", node.at) for node in jobs}
        for node, job in jobs.items():
            all_jobs[own[node]] = replace(job, node=own[node], before=frozenset(own[n] for n in job.before))
    total = sum(job.seconds for job in all_jobs.values())
    print(f"{len(real)} sequences, {len(all_jobs)} nodes, {total:.1f} s of computing, made {SLEPT:g} s")
    times = SLEPT / total
    all_jobs = {node: replace(job, seconds=job.seconds * times) for node, job in all_jobs.items()}
    print(f"{'workers':>8}{'predicted':>12}{'was':>10}{'was over predicted':>20}")
    for workers in CHECKED:
        keys["compute"] = {"executor": "threads", "workers": workers}
        again = Dataset.of({**keys, "output": f"{folder}/{workers}/{{name}}"}, application=APPLICATION)
        with replayed(real.store, times):
            heard = Heard()
            again.run(listeners=[heard])
        predicted, was = makespan(all_jobs, workers), heard.last - heard.first
        print(f"{workers:>8}{predicted:>10.1f} s{was:>8.1f} s{was / predicted:>20.2f}", flush=True)


@dataclass
class Heard:
    """When the first node was sent and the last one done."""

    first: float = float("inf")
    last: float = 0.0

    def hear(self, event: dict[str, Any]) -> None:
        """Notes the time of an event of a node."""
        if event["event"] == "start":
            self.first = min(self.first, event["time"])
        if event["event"] == "finish":
            self.last = max(self.last, event["time"])


@contextmanager
def replayed(store: Store, times: float) -> Iterator[None]:
    """Nodes sleep so many times as long as they took before and return what they returned then."""
    here = threading.local()
    run, call = execute._run, Task.__call__

    def noted(bench: Any, number: int, step: Any, task: Any, key: str, inputs: Any) -> Any:
        here.key = key
        try:
            return run(bench, number, step, task, key, inputs)
        finally:
            here.key = None

    def slept(task: Any, *given: Any, **named: Any) -> Any:
        record = store.record(here.key) if getattr(here, "key", None) else None
        if record is None:  # an origin, or a node of the summary
            return call(task, *given, **named)
        time.sleep(record.seconds * times)
        return store.read(task.returns, record.artifact)

    with unittest.mock.patch.object(execute, "_run", noted), unittest.mock.patch.object(Task, "__call__", slept):
        yield


if __name__ == "__main__":
    main()
