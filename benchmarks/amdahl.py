"""How much more workers help: the nodes of a run, with the seconds on record, scheduled on 1 to 64 workers.

    python benchmarks/amdahl.py [OUTPUT_FOLDER | --frames 36 --vertices 6000] [--times 3] [--until skeleton]

Prints the speedup by number of workers, the longest path through the graph by task, and the seconds of every task. With
`--path` it also prints, for some numbers of workers, the nodes that the end waited for, each sent when the one before was done,
by task, and how long workers had nothing to do meanwhile. Without a
folder it computes a generated human first, in one thread, and counts processor seconds, which no other program disturbs; the
records of a run hold seconds by the clock. The process that computes it also holds the plan, which workers do not; so
nodes do not search it for garbage.

The simulation keeps to the loom: nodes travel in its parcels, the deepest task first, and one process sends them all.
`--times 3` makes the sequence three times as long: there are three of every node of a frame, a traversal is three times as
deep, and what gathers all frames takes three times as long.
"""

import argparse
import contextlib
import gc
import tempfile
import time
import unittest.mock
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

from scheduled_run import Job, Jobs, Parcel, longest_path, makespan, scheduled

from kinetree.errors import UnknownNodeError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.history import History
from kinetree.pipeline.node import Node, parse, project
from kinetree.pipeline.planning.ready import urgency
from kinetree.pipeline.running import execute
from kinetree.pipeline.storage.store import Record
from kinetree.pipeline.task import Space

WORKERS = (1, 2, 4, 8, 16, 64)
PATHS = (2, 8, 64)
FRAME = "frame"


def main() -> None:
    """Prints the tables."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("folder", type=Path, nargs="?", help="output folder of a run that is done")
    options.add_argument("--frames", type=int, default=36, help="of the generated human")
    options.add_argument("--vertices", type=int, default=6000, help="of the generated human")
    options.add_argument("--times", type=int, default=1, help="how many times as long the sequence is to be")
    options.add_argument("--path", type=int, nargs="*", metavar="WORKERS", help="what so many workers wait for (2 8 64)")
    options.add_argument("--until", nargs="+", default=(), help="only these tasks and those they need")
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as beside:
        pipeline = Pipeline.of(chosen.folder) if chosen.folder else computed(Path(beside), chosen.frames, chosen.vertices)
        jobs = recorded(pipeline, chosen.until or pipeline.tasks.unasked)
    jobs = stretched(jobs, chosen.times)
    alone = makespan(jobs, 1)
    for workers in WORKERS:
        seconds = makespan(jobs, workers)
        print(f"{workers:>4} workers{seconds:>10.1f} s{alone / seconds:>8.2f} times, {alone / seconds / workers:>4.0%} busy")
    path = longest_path(jobs)
    print(f"\nlongest path: {sum(job.seconds for job in path):.1f} s in {len(path)} nodes")
    _print_tasks(path)
    for workers in chosen.path or (PATHS if chosen.path is not None else ()):
        _print_path(jobs, workers)
    print("\nall nodes")
    _print_tasks(jobs.values())


def computed(folder: Path, frames: int, vertices: int) -> Pipeline:
    """The run of a generated human in one thread, with processor seconds on record."""
    synth = {"figure": "human", "frames": frames, "vertices": vertices}
    pipeline = Pipeline.of({"output": str(folder), "source": {"synth": synth}, "compute": {"executor": "sync"}})
    with unittest.mock.patch.object(execute, "time", SimpleNamespace(perf_counter=_processor_seconds)):
        pipeline.run()
    return pipeline


def _processor_seconds() -> float:
    """The clock of the nodes; what there is when a node begins is not searched for garbage while it computes."""
    gc.freeze()
    return time.process_time()


def recorded(pipeline: Pipeline, names: Sequence[str]) -> Jobs:
    """The nodes of the last run into a folder, of the named tasks and what they need, with the seconds on record.

    raises : ValueError where nothing is on record
    """
    graph = pipeline.tasks.until(names)
    found = {node: record for label, record in last_records(pipeline).items() if (node := _node(label, graph))}
    if not found:
        raise ValueError(f"{pipeline.config.output} holds no record; run it first")
    urgent = urgency(graph)
    jobs: Jobs = {}
    for node, record in found.items():
        task = graph.by_name[node.task]
        tellers = {graph.openers[space].name for space in graph.needed_spaces(task)}
        tellers |= {graph.writers[task.along].name} if task.along else set()
        read = {_node(label, graph) for argument in record.inputs for label in argument["nodes"]}
        read |= {n for n in found if n.task in tellers and _agree(task.over, node, graph.by_name[n.task].over, n)}
        before = frozenset(n for n in read if n and n in found and n != node)
        jobs[node] = Job(node, task.over, urgent[node.task], node.task in graph.aside, task.is_chain, record.seconds, before)
    return jobs


def last_records(pipeline: Pipeline) -> dict[str, Record]:
    """By label, the records of the nodes that the last run into a folder has; runs before it may have had others."""
    history = History.of(pipeline.store, pipeline.config)
    listed = [run for run in history.heads.of(history.output) if run["list"]]
    labels = (pipeline.store.run_records.nodes(listed[-1]) or {}) if listed else {}
    recalled = {label: history.recall(label) for label in labels}
    return {label: record for label, record in recalled.items() if isinstance(record, Record)}


def stretched(jobs: Jobs, times: int) -> Jobs:
    """The nodes of a sequence so many times as long, as the head of this file says."""
    longer: Jobs = {}
    frames = len({node.at[job.space.index(FRAME)] for node, job in jobs.items() if FRAME in job.space})
    for job in jobs.values():
        if FRAME in job.space:
            copies = [replace(job, node=_copy(job, times, k), before=_read_by_copy(jobs, job, times, k)) for k in range(times)]
        else:
            gathered = sum(FRAME in jobs[n].space for n in job.before)
            seconds = job.seconds * (times if gathered >= frames else 1)
            read = [_copy(jobs[n], times, k) for n in job.before for k in range(times)]
            copies = [replace(job, seconds=seconds, before=frozenset(read))]
        longer.update((copy.node, copy) for copy in copies)
    return longer


def _read_by_copy(jobs: Jobs, job: Job, times: int, copy: int) -> frozenset[Node]:
    """What a copy of a frame's node reads: of its own frame the same copy, of a neighbour's the nearest one."""
    found = set()
    for read in (jobs[node] for node in job.before):
        if FRAME not in read.space:
            found.add(read.node)
            continue
        here, there = (j.node.at[j.space.index(FRAME)] for j in (job, read))
        beside = copy + (there > here) - (there < here)
        inside = replace(read, node=Node(read.node.task, job.node.at)) if 0 <= beside < times and here != there else read
        found.add(_copy(inside, times, beside % times))
    return frozenset(found)


def _copy(job: Job, times: int, number: int) -> Node:
    at = (n * times + number if dim == FRAME else n for dim, n in zip(job.space, job.node.at, strict=True))
    return Node(job.node.task, tuple(at))


def _node(label: str, graph: Graph) -> Node | None:
    """The node of a label; None of a task that is no more, or that ran over another dimension then."""
    with contextlib.suppress(UnknownNodeError):
        return parse(label, graph)
    return None


def _agree(space: Space, node: Node, other_space: Space, other: Node) -> bool:
    shared = tuple(dim for dim in space if dim in other_space)
    return project(node.at, space, shared) == project(other.at, other_space, shared)


def _print_path(jobs: Jobs, workers: int) -> None:
    """By task, how long the end waited for its nodes, and how many seconds workers had nothing to do meanwhile."""
    parcels = scheduled(jobs, workers)
    waited: defaultdict[str, list[float]] = defaultdict(lambda: [0.0, 0.0, 0.0])
    parcel: Parcel | None = parcels[-1]
    while parcel is not None:
        took = parcel.end - parcel.begin
        busy = sum(max(min(p.end, parcel.end) - max(p.begin, parcel.begin), 0.0) for p in parcels)
        computing = sum(jobs[node].seconds for node in parcel.nodes)
        for node in parcel.nodes:
            share = jobs[node].seconds / computing if computing else 1.0 / len(parcel.nodes)
            row = waited[node.task]
            row[:] = row[0] + 1, row[1] + share * took, row[2] + share * (workers * took - busy)
        parcel = parcel.sent_after
    print(f"\nwhat {workers} workers waited for")
    print(f"{'task':<24}{'nodes':>8}{'seconds':>10}{'idle':>10}")
    for task, (nodes, seconds, idle) in sorted(waited.items(), key=lambda row: -row[1][2]):
        print(f"{task:<24}{nodes:>8.0f}{seconds:>10.2f}{idle:>10.2f}")


def _print_tasks(jobs: Iterable[Job]) -> None:
    seconds: defaultdict[str, list[float]] = defaultdict(list)
    for job in jobs:
        seconds[job.node.task].append(job.seconds)
    print(f"{'task':<24}{'nodes':>8}{'seconds':>10}{'longest':>10}")
    for task, took in sorted(seconds.items(), key=lambda row: -sum(row[1])):
        print(f"{task:<24}{len(took):>8}{sum(took):>10.2f}{max(took):>10.2f}")


if __name__ == "__main__":
    main()
