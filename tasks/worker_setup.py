"""What every worker process needs: the tasks, and compiled kernels where all are on disk."""

import importlib
import os
import time

from kinetree.tasks.compiled_ahead import is_all_compiled
from kinetree.tasks.numerics.kernel_list import compile_all, lines

LONGEST = 5.0
"""Seconds after which no further kernel is loaded: several times what all take from disk. Where they must be compiled, the
folder emptied or the processor another one, workers compile those that they call."""


def load() -> None:
    """Imports and loads it, as long as the run lives."""
    importlib.import_module("kinetree.tasks.methods")
    run, until = os.getppid(), time.monotonic() + LONGEST
    if is_all_compiled():  # else the first worker would wait until all are
        compile_all(lines(), lambda: os.getppid() == run and time.monotonic() < until)
