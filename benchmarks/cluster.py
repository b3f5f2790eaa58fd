"""What a cluster costs and gives: seconds per node by executor, one worker against two, planning a large graph, and questions
about a store with many records, these in processor seconds.

    python benchmarks/cluster.py [--frames 60] [--nodes 100000] [--records 100000] [--only costs plan records]

Prints one table. `faults.py` disturbs runs.
"""

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from overhead import CHAIN

from kinetree.pipeline.storage.packed import packed
from kinetree.pipeline.storage.sealed import sealed
from kinetree.pipeline.storage.store import artifact_path

RUNS = 20
"""Runs that left the records of the store that is asked."""
INSIDE = {"cluster": "distributed:LocalCluster", "options": {"n_workers": 0, "processes": False, "threads_per_worker": 2}}
"""dask's scheduler and worker as threads of this process."""


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--frames", type=int, default=60, help="frames of the runs, three nodes each")
    options.add_argument("--nodes", type=int, default=100_000, help="nodes of the planned graph")
    options.add_argument("--records", type=int, default=100_000, help="records in the store that is asked")
    options.add_argument("--only", nargs="+", choices=("costs", "plan", "records"), default=("costs", "plan", "records"))
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "chain_of_three.py").write_text(CHAIN)
        sys.path.insert(0, folder)
        os.environ["PYTHONPATH"] = os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)
        counts = {"costs": (_costs, chosen.frames), "plan": (_plan, chosen.nodes), "records": (_records, chosen.records)}
        for measure, count in (counts[name] for name in chosen.only):
            for what, value in measure(Path(folder), count):
                print(f"{what:<64}{value:>16}", flush=True)


def _pipeline(folder: Path, frames: int, compute: dict[str, Any]) -> Any:
    import chain_of_three as toys  # type: ignore[import-not-found]

    from kinetree.pipeline.graph import Graph
    from kinetree.pipeline.inspect import Pipeline

    graph = Graph.of((toys.source, toys.first, toys.second, toys.third, toys.total))
    return Pipeline.of({"output": str(folder), "source": {"count": frames}, "compute": compute}, methods={"chain": graph})


def _costs(folder: Path, frames: int) -> Iterator[tuple[str, str]]:
    chosen: dict[str, dict[str, Any]] = {
        "sync": {"executor": "sync"},
        "threads, 2": {"executor": "threads", "workers": 2},
        "dask's scheduler in this process, 2 threads": {**INSIDE, "workers": 1},
        "processes, 1": {"executor": "processes", "workers": 1},
        "processes, 2": {"executor": "processes", "workers": 2},
    }
    _seconds(_pipeline(folder / "warm", 1, INSIDE | {"workers": 1}))  # imports
    for number, (name, compute) in enumerate(chosen.items()):
        start = _seconds(_pipeline(folder / f"small{number}", 1, compute))
        spent = _seconds(_pipeline(folder / f"large{number}", frames, compute))
        yield f"{name}: a run of 4 nodes", f"{start:.2f} s"
        yield f"{name}: each node more, storing 13,000×3", f"{1000 * (spent - start) / (3 * (frames - 1)):.1f} ms"


def _seconds(pipeline: Any) -> float:
    started = time.perf_counter()
    assert pipeline.run()["status"] == "done"
    return time.perf_counter() - started


def _plan(folder: Path, nodes: int) -> Iterator[tuple[str, str]]:
    started = time.perf_counter()
    plan = _pipeline(folder / "planned", nodes // 3, {"executor": "sync"}).plan()
    yield f"plan of {len(plan.nodes)} nodes, nothing stored", f"{time.perf_counter() - started:.1f} s"


def _records(folder: Path, count: int) -> Iterator[tuple[str, str]]:
    """Questions about a store in which earlier runs left so many records, which nobody reads any more."""
    from kinetree.pipeline.storage.gc import collect

    def pipeline(**_: object) -> Any:
        return _pipeline(folder / "many", 30, {"executor": "sync"})

    pipeline().run()
    _leave(pipeline().store, count)
    questions: dict[str, Callable[[], Any]] = {
        "runs": lambda: pipeline().runs(),
        "plan, all up to date": lambda: pipeline().plan(),
        "why of one node": lambda: pipeline().why("third[frame=3]"),
        "gc --dry-run": lambda: collect(pipeline().store, dry=True),
        "gc": lambda: collect(pipeline().store),
    }
    for name, ask in questions.items():
        started = time.process_time()
        answer = ask()
        yield f"{count} records and artifacts of {RUNS} runs more: {name}", f"{time.process_time() - started:.2f} s"
    assert len(answer.records) == len(answer.artifacts) == count
    assert pipeline().plan().is_done


def _leave(store: Any, count: int) -> None:
    """Runs, records and artifacts like those that are there, under names of their own."""
    (run,) = store.runs()
    like = asdict(next(iter(store.records.all())))
    rng = np.random.default_rng(0)
    for number in range(RUNS):
        name = f"20000101-0000{number:02d}-0000"
        pairs = [(rng.bytes(20).hex(), rng.bytes(20).hex()) for _ in range(count // RUNS)]
        files = {f"{key}.json": sealed({**like, "key": key, "artifact": digest}) for key, digest in pairs}
        store.place.put(f"packs/{name}.zip", packed(files, is_deflated=True))
        nodes = {f"n[frame={n}]": {"state": "ran", "key": key, "artifact": digest} for n, (key, digest) in enumerate(pairs)}
        store.write_run(name, {**run, "name": name, "nodes": nodes})
        for _, digest in pairs:
            store.place.put(artifact_path(digest), b"PK")


if __name__ == "__main__":
    main()
