"""Workers for several loops, one after the other: started when there is something to compute, and once."""

import contextlib
from types import TracebackType
from typing import TYPE_CHECKING, Any

from kinetree.errors import ConfigError
from kinetree.pipeline.application import helped

if TYPE_CHECKING:  # what computes nothing does without dask
    from kinetree.pipeline.running.jobs import Jobs
    from kinetree.pipeline.running.launch import Launcher
    from kinetree.pipeline.settings.config import Compute
    from kinetree.pipeline.storage.store import Store


def refuse_no_client(client: Any) -> None:
    """Raises ConfigError where what a program hands in to run on is neither None nor a `distributed.Client`.

    It goes by the names of classes: what computes nothing does without dask.
    """
    names = {(cls.__module__.partition(".")[0], cls.__name__) for cls in type(client).__mro__}
    if client is not None and ("distributed", "Client") not in names:
        raise ConfigError(f"expected a distributed.Client to run on, got {client!r}; an address belongs into compute.scheduler")


class Workers:
    """A context that ends what it started.

    beside, setup : what the product has beside a run and what its worker processes load (`Application`)
    """

    def __init__(self, compute: "Compute", client: Any = None, *, beside: str | None = None, setup: str | None = None) -> None:
        self._compute, self._client, self._setup = compute, client, setup
        self._beside = beside if client is None and compute.is_here else None
        self._stack = contextlib.ExitStack()
        self._launch: Launcher | None = None

    def __enter__(self) -> "Workers":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._stack.__exit__(kind, error, trace)

    def run(self, jobs: "Jobs", store: "Store") -> None:
        """Runs schedules until there are no more; raises as `run_all`."""
        from kinetree.pipeline.running.launch import launcher
        from kinetree.pipeline.running.run import run_all
        from kinetree.pipeline.running.worker_parent import WorkerParent

        if self._launch is None:
            self._stack.enter_context(helped(self._beside))
            parent = self._stack.enter_context(WorkerParent(self._setup))
            self._launch = self._stack.enter_context(launcher(self._compute, self._client, parent))
        run_all(jobs, store, self._launch)
