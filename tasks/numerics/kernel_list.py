"""The kernels of a run, in the order of their first call, with the types of their arguments: what can be compiled beforehand.

`kernels.jsonl` has a line for each. A line that no longer fits the code is passed over.
"""

import contextlib
import importlib
import json
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.errors import NumbaError
from numba.np.numpy_support import as_dtype, from_dtype

LIST = Path(__file__).with_name("kernels.jsonl")
Line = tuple[str, list[Any]]
_ARRAY = re.compile(r"(\w+)\[(\d)([ACF])\](!?)")


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
