"""Our own worker processes while they start: one that ends then is started again, and where all do, the run ends in words."""

import ast
import asyncio
import contextlib
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kinetree.errors import ClusterError
from kinetree.pipeline.running.worker_parent import GUARD

FOLLOW_SECONDS = 0.25
"""How often the scheduler is asked for its workers."""
REPLACE_SECONDS = 30.0
"""Without any worker of our own, after which new ones are started: several times what a start takes on a busy machine."""
STARTS = 3
"""How often workers are started, none of which has come, before the run ends."""
COMPARES = (ast.Compare, ast.Match)
GONE = ("failed", "closed")
"""States of dask's that nothing follows."""


@dataclass
class Starts:
    """What became of the workers that a run has started."""

    lost: int = 0
    """How often some of them ended and were started again."""
    in_vain: int = 0
    """How often in succession all of them ended while they started."""
    failure: Exception | None = None
    """Why nobody looks after them any longer."""

    def check(self) -> None:
        """Raises ClusterError where no worker starts, or nobody looks after them."""
        if self.failure is not None:
            what = f"{type(self.failure).__name__}: {self.failure}"
            raise ClusterError(f"worker processes are no longer looked after ({what})") from self.failure
        script = unguarded_script()
        if self.in_vain and script:
            raise ClusterError(f"no worker process starts: {script} starts the run; {GUARD}")
        if self.in_vain >= STARTS:
            raise ClusterError(f"no worker process starts, {self.in_vain} times tried; what they print says why")


def unguarded_script() -> str:
    """The file of this program, where workers import it and nothing in its text compares `__name__`; else "".

    Python's workers import no `__main__.py` of a package (`python -m PACKAGE`).
    """
    main = sys.modules.get("__main__")
    file = getattr(main, "__file__", None)
    module = getattr(getattr(main, "__spec__", None), "name", "")
    if file is None or module.rpartition(".")[2] == "__main__":
        return ""
    try:
        tree = ast.parse(Path(file).read_bytes())
    except (OSError, SyntaxError, ValueError):  # what cannot be read is not blamed
        return ""
    compared = [node.subject if isinstance(node, ast.Match) else node for node in ast.walk(tree) if isinstance(node, COMPARES)]
    names = {name.id for node in compared for name in ast.walk(node) if isinstance(name, ast.Name)}
    return "" if "__name__" in names else str(file)


@contextlib.contextmanager
def looked_after(cluster: Any, workers: int, starts: Starts) -> Iterator[None]:
    """Has so many workers in a LocalCluster until the block ends, whatever becomes of them; `starts` says what did."""

    async def looking_after() -> None:
        try:
            await _look_after(cluster, workers, starts)
        except Exception as error:  # whatever it is, the run would wait for workers for ever
            starts.failure = error

    looking = asyncio.run_coroutine_threadsafe(looking_after(), cluster.loop.asyncio_loop)
    try:
        yield
    finally:
        looking.cancel()


async def _look_after(cluster: Any, workers: int, starts: Starts) -> None:
    """Starts what a nanny does not: workers that end before they have come, and those whose nanny ends."""
    empty, times = 0.0, 0
    while True:
        await asyncio.sleep(FOLLOW_SECONDS)
        is_empty = not cluster.scheduler.workers
        empty, times = (empty + FOLLOW_SECONDS, times) if is_empty else (0.0, 0)
        starts.in_vain = starts.in_vain if is_empty else 0
        gone = [name for name, nanny in cluster.workers.items() if nanny.status.name in GONE]
        if gone:
            starts.in_vain += is_empty and len(gone) == len(cluster.workers)
            await asyncio.sleep(min(FOLLOW_SECONDS * 2**starts.lost, REPLACE_SECONDS))
            starts.lost += 1
            for name in gone:
                cluster.workers.pop(name, None)
            cluster.scale(workers)
        elif not is_empty and set(cluster.worker_spec) - set(cluster.workers):  # dask lets go of a nanny without a worker
            cluster.scale(workers)
        elif empty > REPLACE_SECONDS * 2**times:  # longer each time: a busy machine may start them slowly
            empty, times = 0.0, times + 1
            cluster.scale(0)
            while cluster.workers:  # names are given anew once their workers are gone
                await asyncio.sleep(FOLLOW_SECONDS)
            cluster.scale(workers)
