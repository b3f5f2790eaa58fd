"""The process that worker processes of this machine are forked from: what all need is imported once, and while the run plans.

Where there can be none, workers start as dask starts them, and each imports by itself.
"""

import contextlib
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from multiprocessing import current_process, forkserver, get_all_start_methods, resource_tracker
from pathlib import Path
from types import TracebackType
from typing import Any, ClassVar

from kinetree.errors import ConfigError
from kinetree.pipeline.running import worker_preload

CHOSEN = "DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD"
"""The variable by which a user says how dask starts processes; then there is none."""
PATIENCE = 1.0
"""Seconds in which its end is waited for. One that is still importing ends a little later, and one of which another part of
this program has children ends after them."""

GUARD = 'what starts it belongs under `if __name__ == "__main__":`, since every worker process imports the script'


def refuse_within_import() -> None:
    """Raises ConfigError in a worker process that is about to start, and imports the script that runs the pipeline."""
    if getattr(current_process(), "_inheriting", False):
        raise ConfigError(f"a run on processes was started by a worker process: {GUARD}")


class WorkerParent:
    """Begun by whoever knows first that there is something to compute; it ends with the block.

    Python has one server of that kind. Runs of one program at the same time share the one that the first of them began, and the
    last of them ends it.

    setup : what the product has it load (`Application.worker_setup`)
    """

    _lock = threading.Lock()
    _users: ClassVar[list["WorkerParent"]] = []
    _preload: ClassVar[list[str]] = []
    """What the program had set before."""

    def __init__(self, setup: str | None = None) -> None:
        self._setup = setup or ""
        self._server: Any = None

    def __enter__(self) -> "WorkerParent":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        with self._lock:
            if self._server is not None:
                self._users.remove(self)
                if not self._users:
                    _ended(self._server)
                    self._server._preload_modules = list(self._preload)  # dask has set its own since
                self._server = None

    def begin(self, environment: Mapping[str, str]) -> None:
        """Starts the process with these variables set, unless it is there; returns at once.

        There is none but on Linux and where dask starts processes as it likes; none where this program has a server of that
        kind already, which is somebody else's; and none where the system refuses its socket (a long path of temporary files).
        """
        with self._lock:
            server: Any = getattr(forkserver, "_forkserver", None)
            is_known = all(hasattr(server, name) for name in ("_forkserver_pid", "_forkserver_alive_fd", "_preload_modules"))
            is_wanted = sys.platform == "linux" and "forkserver" in get_all_start_methods() and CHOSEN not in os.environ
            if self._server is not None or not is_wanted or not is_known:
                return
            if self._users or (server._forkserver_pid is None and self._is_started(server, environment)):
                self._server = server
                self._users.append(self)

    def _is_started(self, server: Any, environment: Mapping[str, str]) -> bool:
        # nothing is imported from the folder that the user happens to be in
        variables = {**environment, worker_preload.SETUP: self._setup, "PYTHONSAFEPATH": "1"}
        self._preload[:] = server._preload_modules
        is_started = False
        try:
            with _set({**variables, "PYTHONWARNINGS": _without_leaks()}):
                resource_tracker.ensure_running()  # which lets interrupts through again
            with _set(variables), _interrupts_held_back():
                forkserver.set_forkserver_preload([worker_preload.__name__])
                forkserver.ensure_running()
            is_started = True
        except OSError:
            server._forkserver_pid = None
        finally:
            if not is_started:
                server._preload_modules = list(self._preload)
        return is_started

    @property
    def is_there(self) -> bool:
        """Whether workers can be forked from it."""
        return self._server is not None


def _ended(server: Any) -> None:
    """Has the process end by itself, at once if it has no children left and has loaded all; forgets it either way."""
    pid, address = server._forkserver_pid, server._forkserver_address
    server._forkserver_pid = server._forkserver_address = None
    with contextlib.suppress(OSError, TypeError):
        os.close(server._forkserver_alive_fd)
    server._forkserver_alive_fd = None
    with contextlib.suppress(OSError, TypeError):  # ChildProcessError where a program ignores what becomes of its children
        until = time.monotonic() + PATIENCE
        while os.waitpid(pid, os.WNOHANG) == (0, 0) and time.monotonic() < until:
            time.sleep(0.01)
    with contextlib.suppress(OSError, TypeError):
        Path(address).unlink()


def _without_leaks() -> str:
    """PYTHONWARNINGS of the process that removes what an interrupted run leaves; it would warn of that behind the prompt."""
    return ",".join(filter(None, (os.environ.get("PYTHONWARNINGS"), "ignore:resource_tracker")))


@contextlib.contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """What starts meanwhile hears no Ctrl-C until it says so; one that comes reaches this process afterwards."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


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
