"""How a night over a data set too large to try would go: nodes, objects, requests, dollars, and what holds it up first.

    python benchmarks/simulate.py [--sequences 10000] [--length 500] [--frames 4 8] [--vertices 6000] [--loops 1 4 16]
                                  [--latency 0.02] [--prefixes 256] [--put 5e-6] [--get 4e-7] [--month 0.023] [--json FILE]
    python benchmarks/simulate.py --check [--frames 3 5] [--vertices 600]

Computes a generated human at two lengths, in one thread, with processor seconds on record and every question to the store
counted, and draws straight lines through what it finds: so many a sequence, so many a frame. What grows faster than the
number of frames comes out too small. A store in a bucket is asked the same questions as one in a folder: `put` and listings
are paid by `--put`, other questions by `--get`, in dollars each, and what is stored by `--month`, in dollars for 1 GB. Each
is answered after `--latency` seconds (0: a disk), and below each of `--prefixes` so many a second as `ASKED` says: artifacts
lie in 256 folders, which a service spreads when it has seen the load; until then there is one.

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
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from amdahl import recorded
from scheduled_run import AT_WORKER, OF_NODE, OF_PARCEL, Jobs, longest_path, makespan

from kinetree.pipeline.dataset.dataset import Dataset
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.node import Node
from kinetree.pipeline.running import execute
from kinetree.pipeline.storage.bucket import ASKED_AT_ONCE, LISTED_AT_ONCE
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.store import MARKER, Store
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
AT_ONCE = {"get_all": ASKED_AT_ONCE, "remove_all": LISTED_AT_ONCE}
"""How many objects of these a bucket is asked for at a time."""
WORKERS = (1, 4, 16, 64, 256, 1024, 4096, 16384)
INDEX_BYTES = 2900
"""Memory that a record takes in every process that reads the store, measured on 1,822 records in four packs."""
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
    asked_by_workers: float
    """Questions that a node waits for, one after the other."""
    asked_by_loop: float
    """Likewise of the process of the loop; what it asks for many at a time counts by rounds."""
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
    options.add_argument("--latency", type=float, default=0.02, help="seconds")
    options.add_argument("--prefixes", type=int, default=256)
    options.add_argument("--check", action="store_true")
    options.add_argument("--json", type=Path)
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if chosen.check:
            check(Path(folder), max(chosen.frames), chosen.vertices)
            return
        measured(Path(folder) / "warm", chosen.frames[0], chosen.vertices)  # imports and compiles what no frame costs again
        short, long = (measured(Path(folder) / str(n), n, chosen.vertices) for n in chosen.frames)
    apart = chosen.frames[1] - chosen.frames[0]
    frame = Units(**{name: (getattr(long, name) - value) / apart for name, value in asdict(short).items()})
    sequence = short.plus(frame, chosen.length - chosen.frames[0])
    if chosen.json:
        chosen.json.write_text(json.dumps({"frame": asdict(frame), "sequence": asdict(sequence)}, indent=1))
    _print_units(frame, sequence, chosen.sequences)
    _print_dollars(sequence, chosen)
    for loops in chosen.loops:
        _print_night(sequence, chosen, loops)


def measured(folder: Path, frames: int, vertices: int) -> Units:
    """What one generated human costs."""
    takes = folder / "takes"
    write_sequence(SynthParams(figure="human", frames=frames, vertices=vertices), takes)
    pipeline = Pipeline.of({"output": str(folder / "out"), "source": {"input": str(takes)}, "compute": {"executor": "sync"}})
    begun: list[float] = []
    asked = Asked()

    def noted(*work: Any) -> Any:
        begun.append(time.process_time())
        asked.who = "workers"
        try:
            return compute(*work)
        finally:
            asked.who = "loop"

    compute = execute.compute
    with asked.counting(), ExitStack() as patches:
        clock = SimpleNamespace(perf_counter=time.process_time)
        patches.enter_context(unittest.mock.patch.object(execute, "time", clock))
        patches.enter_context(unittest.mock.patch.object(execute, "compute", noted))
        started = time.process_time()
        told = pipeline.run()
    if told["status"] != "done":
        raise SystemExit(f"{frames} frames: {told['failures'][0]['message']}")
    print(f"{frames} frames:", ", ".join(f"{what} {count}" for what, count in asked.named.most_common(8)))
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
        put=sum(asked.paid["put", who] for who in ("loop", "workers")),
        get=sum(asked.paid["get", who] for who in ("loop", "workers")),
        asked_by_workers=asked.waits["workers"],
        asked_by_loop=asked.waits["loop"],
        path=sum(job.seconds for job in longest_path(jobs)),
    )


@dataclass
class Asked:
    """What stores in folders are asked."""

    who: str = "loop"
    paid: Counter[tuple[str, str]] = field(default_factory=Counter)
    """By how it would be paid, and by whom."""
    waits: dict[str, float] = field(default_factory=lambda: {"loop": 0.0, "workers": 0.0})
    """By whom, one after the other."""
    named: Counter[str] = field(default_factory=Counter)
    """By whom, and what."""
    at_once: int = 1

    @contextmanager
    def counting(self) -> Iterator[None]:
        """Counts what is asked meanwhile."""
        with ExitStack() as patches:
            for name in {*QUESTIONS, *AT_ONCE} & set(vars(Folder)):
                patches.enter_context(unittest.mock.patch.object(Folder, name, self._counting(name, getattr(Folder, name))))
            patches.enter_context(unittest.mock.patch.object(Folder, "is_remote", True))  # the ways of a bucket are taken
            yield

    def _counting(self, name: str, original: Any) -> Any:
        def ask(place: Folder, *given: Any, **named: Any) -> Any:
            if not (place.root / MARKER).exists():
                return original(place, *given, **named)
            if name in AT_ONCE:
                self.at_once = AT_ONCE[name]
                try:
                    return original(place, *given, **named)
                finally:
                    self.at_once = 1
            self.paid[QUESTIONS[name], self.who] += 1
            self.named[f"{self.who}: {name} {str(given[0]).partition('/')[0]}"] += 1
            self.waits[self.who] += 1 / self.at_once
            return original(place, *given, **named)

        return ask


def bounds(sequence: Units, chosen: argparse.Namespace, workers: int, loops: int) -> dict[str, float]:
    """Seconds by each thing that a night cannot be faster than; the longest of them is what holds it up."""
    n, latency = chosen.sequences, chosen.latency
    sent = OF_NODE * sequence.nodes + OF_PARCEL * sequence.parcels
    return {
        "workers": n * (sequence.compute + AT_WORKER * sequence.nodes + latency * sequence.asked_by_workers) / workers,
        "the loop": n * (sequence.begin + sent + latency * sequence.asked_by_loop) / loops,
        "the bucket's writes": n * sequence.put / ASKED["put"] / chosen.prefixes,
        "the bucket's reads": n * sequence.get / ASKED["get"] / chosen.prefixes,
        "one sequence's longest path": sequence.path + latency * sequence.asked_by_workers * sequence.path / sequence.compute,
    }


def _print_units(frame: Units, sequence: Units, sequences: int) -> None:
    print(f"{'':<12}{'a frame more':>16}{'a sequence':>16}{'the data set':>16}")
    for name, value in asdict(sequence).items():
        print(f"{name:<12}{getattr(frame, name):>16,.4g}{value:>16,.6g}{value * sequences:>16,.4g}")


def _print_dollars(sequence: Units, chosen: argparse.Namespace) -> None:
    n = chosen.sequences
    put, get = n * sequence.put * chosen.put, n * sequence.get * chosen.get
    month = n * sequence.bytes / 1e9 * chosen.month
    print(f"\nrecords in the memory of every process: {n * sequence.nodes * INDEX_BYTES / 1e9:,.0f} GB")
    print(f"dollars: {put:,.0f} to write and list, {get:,.0f} to read, {month:,.0f} a month to keep")


def _print_night(sequence: Units, chosen: argparse.Namespace, loops: int) -> None:
    print(f"\n{loops} process{'es' if loops > 1 else ''} that send{'' if loops > 1 else 's'}")
    print(f"{'workers':>8}{'hours':>10}{'busy':>7}  held up by")
    for workers in WORKERS:
        held = bounds(sequence, chosen, workers, loops)
        what = max(held, key=held.__getitem__)
        print(f"{workers:>8}{held[what] / 3600:>10.1f}{held['workers'] / held[what]:>7.0%}  {what}")


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
