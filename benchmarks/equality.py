"""Whether results are the same bytes wherever they are computed: executors, workers, numbers of threads, instruction sets.

    python benchmarks/equality.py [--figures human quadruped] [--frames 6] [--vertices 800] [--keep FOLDER]

Every cell of the matrix is one run of the default method, in a process of its own and into a store of its own, compared node by
node with the first cell. Where results differ, the nodes are named at which that begins: equal inputs, another result.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
INSTRUCTIONS = ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")
"""What stands for another processor; bytes may differ there."""


@dataclass(frozen=True)
class Cell:
    """Where and how one run is computed."""

    name: str
    compute: dict[str, Any]
    environment: dict[str, str] = field(default_factory=dict)


def _local_cluster(workers: int, *, processes: bool) -> dict[str, Any]:
    options = {"n_workers": 0, "processes": processes, "threads_per_worker": 1, "dashboard_address": None}
    return {"cluster": "distributed:LocalCluster", "options": options, "workers": workers}


CELLS = (
    Cell("sync", {"executor": "sync"}),
    *(Cell(f"threads-{n}", {"executor": "threads", "workers": n}) for n in (1, 2, 3, 4)),
    *(Cell(f"processes-{n}", {"executor": "processes", "workers": n}) for n in (1, 2, 3, 4)),
    Cell("cluster-1", _local_cluster(1, processes=True)),
    Cell("cluster-3", _local_cluster(3, processes=True)),
    Cell("cluster-in-process-2", _local_cluster(2, processes=False)),
    Cell("sync, OMP_NUM_THREADS=2", {"executor": "sync"}, {"OMP_NUM_THREADS": "2"}),
    Cell("threads-2, OMP_NUM_THREADS=2", {"executor": "threads", "workers": 2}, {"OMP_NUM_THREADS": "2"}),
    Cell("processes-2, OMP_NUM_THREADS=2", {"executor": "processes", "workers": 2}, {"OMP_NUM_THREADS": "2"}),
    Cell("sync, OPENBLAS_NUM_THREADS=2", {"executor": "sync"}, {"OPENBLAS_NUM_THREADS": "2"}),
    *(Cell(f"sync, OPENBLAS_CORETYPE={c}", {"executor": "sync"}, {"OPENBLAS_CORETYPE": c}) for c in ("Haswell", "Sandybridge")),
    Cell("sync, numpy without AVX-512", {"executor": "sync"}, {"NPY_DISABLE_CPU_FEATURES": "X86_V4,AVX512_ICL"}),
)


@dataclass(frozen=True)
class NodeRecord:
    """What one node made in a run, and of what."""

    artifact: str
    inputs: tuple[str, ...]
    blas: str


def main() -> None:
    """Prints the matrix; exits with 1 where cells differ that promise the same bytes."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--figures", nargs="+", default=["human", "quadruped"], help="generated bodies")
    options.add_argument("--frames", type=int, default=6)
    options.add_argument("--vertices", type=int, default=800)
    options.add_argument("--method", default="mesoscopic")
    options.add_argument(
        "--cells", nargs="+", default=[cell.name for cell in CELLS], help="which cells, the first to compare with"
    )
    options.add_argument("--keep", type=Path, help="folder for the runs; those that are there already are not computed again")
    chosen = options.parse_args()
    unequal = 0
    for figure in chosen.figures:
        synth = {"figure": figure, "frames": chosen.frames, "vertices": chosen.vertices}
        blocks = {"method": chosen.method, "source": {"synth": synth}}
        with tempfile.TemporaryDirectory() as temporary:
            first: dict[str, NodeRecord] = {}
            for name in chosen.cells:
                cell = next(cell for cell in CELLS if cell.name == name)
                nodes = computed(cell, blocks, (chosen.keep or Path(temporary)) / figure / name.replace(", ", "-"))
                first = first or nodes
                differs = [node for node in {**first, **nodes} if _artifact(first, node) != _artifact(nodes, node)]
                unequal += bool(differs) and not set(INSTRUCTIONS) & set(cell.environment)
                print(f"{figure:<12}{name:<34}{_comparison(first, nodes, differs)}", flush=True)
    sys.exit(unequal > 0)


def computed(cell: Cell, blocks: dict[str, Any], folder: Path) -> dict[str, NodeRecord]:
    """Every node of a run in a process of its own, by label; raises CalledProcessError where it does not end well."""
    from kinetree.pipeline.storage.store import Store

    folder.mkdir(parents=True, exist_ok=True)
    (folder / "run.yaml").write_text(yaml.safe_dump({**blocks, "compute": cell.compute}))
    environment = {name: value for name, value in os.environ.items() if name not in (*THREADS, *INSTRUCTIONS)}
    command = [str(Path(sys.executable).parent / "kinetree"), "run", str(folder / "run.yaml")]
    if not (folder / "out" / "run.json").exists():
        subprocess.run([*command, "--output", str(folder / "out"), "--quiet"], env=environment | cell.environment, check=True)
    store = Store.at(folder / "out" / "store")
    (run,) = store.runs()
    nodes = {}
    for label, node in run["nodes"].items():
        record = store.record(node["key"]) if node["key"] else None
        inputs = tuple(artifact for i in record.inputs for artifact in i["artifacts"]) if record is not None else ()
        nodes[label] = NodeRecord(node["artifact"], inputs, record.versions["blas"] if record is not None else "")
    return nodes


def _artifact(nodes: dict[str, NodeRecord], node: str) -> str | None:
    return nodes[node].artifact if node in nodes else None


def _comparison(first: dict[str, NodeRecord], nodes: dict[str, NodeRecord], differs: list[str]) -> str:
    """How many nodes are equal; where some are not, at which tasks that begins."""
    equal = f"{len(nodes) - len([node for node in differs if node in nodes])} of {len(nodes)} nodes equal"
    begins = Counter(n.partition("[")[0] for n in differs if n in first and n in nodes and first[n].inputs == nodes[n].inputs)
    return equal + (f"; begins in {', '.join(f'{task} ×{n}' for task, n in begins.items())}" if differs else "")


if __name__ == "__main__":
    main()
