"""Compiles kernels in a process beside a first run: within one process numba compiles one function at a time.

The process begins at the end of the list of kernels and the run at its beginning, so that they meet in the middle. What was
compiled is found on disk. `KINETREE_COMPILE_AHEAD=0` leaves the process out.

    python -P -m kinetree.tasks.compiled_ahead      compiles the whole list and returns, to prepare a machine or an image
"""

import contextlib
import fcntl
import os
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

from kinetree.pipeline.identity.key import digest
from kinetree.pipeline.identity.own_code import code_state
from kinetree.tasks.numerics.kernel_folder import kernel_folder

SWITCH = "KINETREE_COMPILE_AHEAD"
NICENESS = 10
"""The run comes first where cores are few."""


@contextlib.contextmanager
def compiling_ahead() -> Iterator[None]:
    """Has the process inside the block, on machines of two cores or more where not all is compiled yet."""
    process = _started() if os.environ.get(SWITCH) != "0" and len(os.sched_getaffinity(0)) > 1 else None
    try:
        yield
    finally:
        if process is not None:
            process.kill()  # what it stores is written beside and renamed
            process.wait()


def main(parent: str | None = None) -> None:
    """Compiles all of the list; for a parent from its end, as long as that lives and no other process is at it."""
    from kinetree.tasks.numerics.kernel_list import compile_all, lines

    every = lines()
    if parent is None:
        kernel_folder().mkdir(parents=True, exist_ok=True)
        print(f"{compile_all(every, lambda: True)} of {len(every)} kernels are ready in {kernel_folder()}")
        _all_done().touch()
        return
    with contextlib.suppress(OSError), (kernel_folder() / "ahead.lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # OSError: the process of another run is at it
        os.nice(NICENESS)
        compile_all(reversed(every), lambda: os.getppid() == int(parent))
        if os.getppid() == int(parent):
            _all_done().touch()


def is_all_compiled() -> bool:
    """Whether all of the list was compiled on this machine."""
    return _all_done().exists()


def _started() -> "subprocess.Popen[bytes] | None":
    quiet: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    with contextlib.suppress(OSError):  # without a folder that can be written, what it compiles is lost
        kernel_folder().mkdir(parents=True, exist_ok=True)
        if sys.executable and os.access(kernel_folder(), os.W_OK) and not is_all_compiled():
            return subprocess.Popen([sys.executable, "-P", "-m", __name__, str(os.getpid())], **quiet)
    return None


def _all_done() -> Path:
    """The file that says that all of the list is compiled, of this code by this numba."""
    return kernel_folder() / f"ahead-{digest({'code': code_state(), 'numba': version('numba'), 'python': sys.version})}"


if __name__ == "__main__":
    main(*sys.argv[1:])
