"""`@inlined`: a function that compiled ones take into themselves; a call with arrays costs more than dozens of products."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def inlined(function: Function) -> Function:
    """Numba's `njit`, put in place of every call in compiled code; called from Python it is compiled by itself each time."""
    dispatcher: Function = numba.njit(inline="always", nogil=True, error_model="numpy")(function)
    return dispatcher
