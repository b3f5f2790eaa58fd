"""The process that worker processes of this machine are forked from: what all need is imported once, and while the run plans.

Where there can be none, workers start as dask starts them, and each imports by itself.
"""

import contextlib
import os
import sys
import threading
from collections.abc import Iterator, Mapping
from multiprocessing import forkserver
from types import TracebackType
from typing import Any, Literal

from kinetree.pipeline.running import worker_preload


class WorkerParent:
    """Begun by whoever knows first that there is something to compute; it ends with the block.

    setup : what the product has it load (`Application.worker_setup`)
    """

    def __init__(self, setup: str | None = None) -> None:
        self._setup = setup or ""
        self._lock = threading.Lock()
        self._server: Any = None

    def __enter__(self) -> "WorkerParent":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        with self._lock:
            if self._server is not None:
                self._server._stop()  # which lets it finish its imports, and give back what they hold of the system
                self._server = None

    def begin(self, environment: Mapping[str, str]) -> None:
        """Starts the process with these variables set, unless it is there; returns at once.

        There is none but on Linux, and none where this program has a server of that kind already, which is somebody else's.
        """
        with self._lock:
            server: Any = getattr(forkserver, "_forkserver", None)
            is_known = hasattr(server, "_stop") and hasattr(server, "_forkserver_pid")
            if self._server is None and sys.platform == "linux" and is_known and server._forkserver_pid is None:
                with _set({**environment, worker_preload.SETUP: self._setup}):
                    forkserver.set_forkserver_preload([worker_preload.__name__])
                    forkserver.ensure_running()
                self._server = server

    @property
    def method(self) -> Literal["forkserver", "spawn"]:
        """How workers start, in the words of multiprocessing."""
        return "spawn" if self._server is None else "forkserver"


@contextlib.contextmanager
def _set(variables: Mapping[str, str]) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
