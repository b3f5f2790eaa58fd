"""How many threads a task's own libraries use: one, or what the task declares, so that its bytes are the same everywhere.

BLAS adds up in another order with another number of threads. Its number is a setting of the whole process, that of OpenMP and
numba one of the thread that calls. Tasks that ask for one thread share a process; a task that
declares more has its process to itself while it runs.
"""

import contextlib
import os
import sys
import threading
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
import threadpoolctl
from threadpoolctl import ThreadpoolController

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""What a library reads that is loaded while a task runs."""


class _Limit:
    """The number of threads per task in this process, and how many tasks run under it."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._tasks = 0
        self._threads = 0
        self._before: contextlib.ExitStack = contextlib.ExitStack()

    def enter(self, threads: int) -> None:
        """Waits until a task with so many threads may run here."""
        with self._changed:
            self._changed.wait_for(lambda: not self._tasks or threads == self._threads == 1)
            if not self._tasks:
                self._before = _limited(threads)
                self._threads = threads
            self._tasks += 1

    def leave(self) -> None:
        """A task is over; after the last one the process has its own number again."""
        with self._changed:
            self._tasks -= 1
            if not self._tasks:
                self._before.close()
            self._changed.notify_all()


_limit = _Limit()


@contextlib.contextmanager
def limited(threads: int = 1) -> Iterator[None]:
    """Inside the block BLAS, OpenMP and numba use so many threads per task in this process."""
    _limit.enter(threads)
    try:
        _limit_numba(threads)  # first, since it may load OpenMP
        own = _controller(len(sys.modules)).select(user_api="openmp").limit(limits=threads)
        try:
            yield
        finally:
            own.restore_original_limits()
    finally:
        _limit.leave()


def blas() -> str:
    """The BLAS libraries that are loaded, with the instruction set that each has chosen: bytes differ between these."""
    libraries = {_named(library) for library in _controller(len(sys.modules)).info() if library["user_api"] == "blas"}
    return ", ".join(sorted(libraries))


@lru_cache(maxsize=1)
def simd() -> str:
    """The instruction set of numpy's own loops and the processor numba compiles for: bytes differ between these too."""
    sets = np.show_config(mode="dicts")["SIMD Extensions"]
    instruction_sets = [f"numpy {[*sets.get('baseline', ()), *sets.get('found', ())][-1]}"]
    numba, llvm = sys.modules.get("numba"), sys.modules.get("llvmlite.binding")
    if numba is not None and llvm is not None:
        instruction_sets.append(f"numba {numba.config.CPU_NAME or llvm.get_host_cpu_name()}")
    return ", ".join(instruction_sets)


def _named(library: dict[str, Any]) -> str:
    return " ".join(str(library[part]) for part in ("internal_api", "version", "architecture") if library.get(part))


def _limited(threads: int) -> contextlib.ExitStack:
    """Limits what is loaded now and what is loaded later; closing it undoes that."""
    before = contextlib.ExitStack()
    _take_control()
    libraries = _controller(len(sys.modules)).select(user_api="blas").limit(limits=threads)
    before.callback(libraries.restore_original_limits)
    before.callback(_take_control)
    for name in VARIABLES:
        before.callback(_set, name, os.environ.get(name))
        _set(name, str(threads))
    return before


def _take_control() -> None:
    """A new threadpoolctl ignores a thread while another that has set OpenBLAS lives; here they take turns."""
    clear = getattr(threadpoolctl.OpenBLASController, "clear_controlling_thread", None)
    if clear is not None:
        clear(force=True)


def _set(name: str, value: str | None) -> None:
    if value is None:
        os.environ.pop(name, None)
    else:
        os.environ[name] = value


def _limit_numba(threads: int) -> None:
    numba = sys.modules.get("numba")
    if numba is not None and hasattr(numba, "set_num_threads"):
        numba.set_num_threads(min(threads, numba.config.NUMBA_NUM_THREADS))


@lru_cache(maxsize=1)
def _controller(_: int) -> ThreadpoolController:
    """The libraries of this process; looked for again when modules were imported, which takes 9 ms."""
    return ThreadpoolController()
