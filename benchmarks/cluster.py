"""What a cluster costs and gives: seconds per node by executor, one worker against two, and planning a large graph.

    python benchmarks/cluster.py [--frames 60] [--nodes 100000]

Prints one table. `faults.py` disturbs runs.
"""

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from overhead import CHAIN

INSIDE = {"cluster": "distributed:LocalCluster", "options": {"n_workers": 0, "processes": False, "threads_per_worker": 2}}
"""dask's scheduler and worker as threads of this process."""


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--frames", type=int, default=60, help="frames of the runs, three nodes each")
    options.add_argument("--nodes", type=int, default=100_000, help="nodes of the planned graph")
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "chain_of_three.py").write_text(CHAIN)
        sys.path.insert(0, folder)
        os.environ["PYTHONPATH"] = os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)
        for what, value in (*_costs(Path(folder), chosen.frames), *_plan(Path(folder), chosen.nodes)):
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


if __name__ == "__main__":
    main()
