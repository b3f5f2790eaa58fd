"""Our own worker processes while they start: one that ends then is started again, and where all do, the run ends in words."""

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
GONE = ("failed", "closed")
"""States of dask's that nothing follows."""


@dataclass
class Starts:
    """What became of the workers that a run has started."""

    lost: int = 0
    """How often some of them ended and were started again."""
    in_vain: int = 0
    """How often in succession all of them ended while they started."""

    def check(self) -> None:
        """Raises ClusterError where no worker starts."""
        script = unguarded_script()
        if self.in_vain and script:
            raise ClusterError(f"no worker process starts: {script} starts the run; {GUARD}")
        if self.in_vain >= STARTS:
            raise ClusterError(f"no worker process starts, {self.in_vain} times tried; what they print says why")


def unguarded_script() -> str:
    """The script that this program is, where it cannot know whether a worker imports it; "" where it can, or there is none."""
    main = sys.modules.get("__main__")
    file = getattr(main, "__file__", None)
    if file is None:
        return ""
    with contextlib.suppress(OSError, UnicodeDecodeError):
        return "" if "__name__" in Path(file).read_text(encoding="utf-8") else str(file)
    return ""


@contextlib.contextmanager
def kept_up(cluster: Any, workers: int, starts: Starts) -> Iterator[None]:
    """Has so many workers in a LocalCluster until the block ends, whatever becomes of them."""
    keeping = asyncio.run_coroutine_threadsafe(_keep_up(cluster, workers, starts), cluster.loop.asyncio_loop)
    try:
        yield
    finally:
        keeping.cancel()


async def _keep_up(cluster: Any, workers: int, starts: Starts) -> None:
    """A nanny starts a worker anew that dies, and none that ends while it starts, nor itself."""
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
        elif empty > REPLACE_SECONDS * 2**times:  # longer each time: a busy machine may start them slowly
            empty, times = 0.0, times + 1
            cluster.scale(0)
            while cluster.workers:  # names are given anew once their workers are gone
                await asyncio.sleep(FOLLOW_SECONDS)
            cluster.scale(workers)
