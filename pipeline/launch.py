"""Where parcels go. In this process dask's synchronous executor computes them (a breakpoint inside a task works), or a pool of
threads; on workers, distributed does. Everything is a future.
"""

import contextlib
import secrets
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Protocol

from dask.local import SynchronousExecutor

from kinetree.pipeline.config import Compute
from kinetree.pipeline.execute import Step, execute
from kinetree.pipeline.sight import Sight


class Future(Protocol):
    """What futures of the standard library and of distributed have in common."""

    def add_done_callback(self, call: Callable[[Any], None], /) -> None:
        """Calls when done."""

    def result(self) -> Any:
        """The value, or raises."""

    def cancel(self) -> Any:
        """Takes it back where it has not begun."""


@dataclass(frozen=True)
class Launcher:
    """Where parcels go: `submit(name, store_url, steps, sight)` gives a future of their results."""

    submit: Callable[[str, str, tuple[Step, ...], Sight], Future]
    window: int
    """How many parcels may be out at once: enough that no worker waits, few enough that the deepest go first."""
    is_apart: bool = True
    """Whether nodes run elsewhere than in the thread that runs the loop."""
    is_elsewhere: bool = False
    """Whether nodes run in other processes than the one that runs the loop."""


@contextlib.contextmanager
def launcher(compute: Compute, client: Any = None) -> Iterator[Launcher]:
    """The launcher that a configuration asks for, or one on a `distributed.Client` handed in."""
    with contextlib.ExitStack() as stack:
        if client is None and compute.scheduler:
            from kinetree.pipeline import clusters

            client = stack.enter_context(clusters.at(compute.scheduler))
        elif client is None and compute.executor == "processes":
            from kinetree.pipeline import clusters

            client = stack.enter_context(clusters.local(compute.worker_count, compute.memory))
        if client is not None:
            yield _on_client(client)
        elif compute.executor == "threads":
            pool = ThreadPoolExecutor(compute.worker_count)
            # an interrupted run does not wait for nodes that may take minutes: what they publish is whole or nothing
            stack.callback(pool.shutdown, wait=False, cancel_futures=True)
            yield Launcher(lambda _, *work: pool.submit(execute, *work), 2 * compute.worker_count)
        else:
            here = SynchronousExecutor()
            yield Launcher(lambda _, *work: here.submit(execute, *work), 1, is_apart=False)


def _on_client(client: Any) -> Launcher:
    from kinetree.pipeline import clusters

    run = secrets.token_hex(8)  # two runs on one scheduler never take each other's results

    def submit(name: str, url: str, steps: tuple[Step, ...], sight: Sight) -> Future:
        return clusters.Remote.of(client, client.submit(execute, url, steps, sight, key=f"{name}-{run}", pure=False))

    return Launcher(submit, 3 * clusters.slots(client), is_elsewhere=True)
