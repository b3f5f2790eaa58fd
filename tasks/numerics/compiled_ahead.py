"""Compiles kernels in a process of its own while a first run computes: numba compiles one function at a time in a process.

`kernels.jsonl` lists the kernels of a run, in the order of their first call, with the types of their arguments. The process
begins at the end of the list and the run at its beginning, so that they meet in the middle. What was compiled is found on disk.
A line that no longer fits the code costs time alone. `KINETREE_COMPILE_AHEAD=0` leaves the process out.

    python -m kinetree.tasks.numerics.compiled_ahead      compiles the whole list and returns, to prepare a machine or an image
"""

import atexit
import contextlib
import fcntl
import importlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.errors import NumbaError
from numba.np.numpy_support import as_dtype, from_dtype

from kinetree.tasks.numerics.kernel_folder import kernel_folder

LIST = Path(__file__).with_name("kernels.jsonl")
SWITCH = "KINETREE_COMPILE_AHEAD"
NICENESS = 10
"""The run comes first where cores are few."""
Line = tuple[str, list[Any]]
_ARRAY = re.compile(r"(\w+)\[(\d)([ACF])\](!?)")


def start_ahead(kernel: str) -> None:
    """Starts the process, once, when a kernel of the list had to be compiled and a second core is there for it.

    kernel : its module and name
    """
    if os.environ.get(SWITCH) != "0" and kernel in _listed() and len(os.sched_getaffinity(0)) > 1 and sys.executable:
        _start()


def lines() -> list[Line]:
    """Module and name of each kernel with its types as text, in the order of the list."""
    return [(name, types) for name, types in map(json.loads, LIST.read_text(encoding="utf-8").splitlines())]


def compile_all(which: Iterable[Line], is_wanted: Callable[[], bool]) -> int:
    """Compiles kernels, or finds them on disk, for as long as somebody wants it; returns how many it could.

    Kernels that are not there any more, and types that they no longer take, are passed over.
    """
    done = 0
    for name, types in which:
        if not is_wanted():
            break
        with contextlib.suppress(NumbaError, ImportError, AttributeError, TypeError):
            module, _, function = name.rpartition(".")
            getattr(importlib.import_module(module), function).compile(tuple(map(type_of, types)))
            done += 1
    return done


def text_of(kind: Any) -> Any:
    """A type of numba's as `type_of` reads it: "float64", "float64[2C]", "float64[2C]!" for one that is not written to; a list
    for a tuple, {"module.Class": list} for a named one, {"record[1C]": fields} for an array of records.

    raises : TypeError for every other type
    """
    if isinstance(kind, numba.types.NamedTuple | numba.types.NamedUniTuple):
        return {f"{kind.instance_class.__module__}.{kind.instance_class.__qualname__}": [text_of(t) for t in kind]}
    if isinstance(kind, numba.types.BaseTuple):
        return [text_of(t) for t in kind]
    if isinstance(kind, numba.types.Array) and isinstance(kind.dtype, numba.types.Record):
        return {f"record[{_form(kind)}": [list(field) for field in as_dtype(kind.dtype).descr]}
    if isinstance(kind, numba.types.Array):
        return f"{text_of(kind.dtype)}[{_form(kind)}"
    if isinstance(kind, numba.types.Number | numba.types.Boolean):
        return str(kind)
    raise TypeError(f"no text for {kind}")


def type_of(text: Any) -> Any:
    """The type of numba's that a text stands for."""
    if isinstance(text, list):
        return numba.types.BaseTuple.from_types([type_of(t) for t in text])
    name, fields = next(iter(text.items())) if isinstance(text, dict) else (text, [])
    if array := _ARRAY.fullmatch(name):
        scalar, dimensions, layout, fixed = array.groups()
        dtype = from_dtype(np.dtype([(key, kind) for key, kind in fields])) if fields else type_of(scalar)
        return numba.types.Array(dtype, int(dimensions), layout, readonly=bool(fixed))
    if fields:
        module, _, kind = name.rpartition(".")
        return numba.types.BaseTuple.from_types([type_of(t) for t in fields], getattr(importlib.import_module(module), kind))
    return numba.types.boolean if name == "bool" else getattr(numba.types, name)


def _form(array: Any) -> str:
    """Dimensions and layout of an array, and whether it is written to."""
    return f"{array.ndim}{array.layout}]{'' if array.mutable else '!'}"


@cache
def _listed() -> frozenset[str]:
    return frozenset(name for name, _ in lines())


@cache
def _start() -> None:
    quiet: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    with contextlib.suppress(OSError):
        process = subprocess.Popen([sys.executable, "-m", __name__, str(os.getpid())], **quiet)
        atexit.register(_stop, process)


def _stop(process: "subprocess.Popen[bytes]") -> None:
    process.terminate()
    process.wait()


def main(parent: str | None = None) -> None:
    """Compiles all of the list; for a parent from its end, as long as that lives and no other process is at it."""
    os.environ[SWITCH] = "0"
    if parent is None:
        every = lines()
        print(f"{compile_all(every, lambda: True)} of {len(every)} kernels are ready")
        return
    with contextlib.suppress(OSError), (kernel_folder() / "ahead.lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # OSError: the process of another worker is at it
        os.nice(NICENESS)
        compile_all(reversed(lines()), lambda: os.getppid() == int(parent))


if __name__ == "__main__":
    main(*sys.argv[1:])
