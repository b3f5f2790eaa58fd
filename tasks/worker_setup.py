"""What every worker process needs: the tasks, and compiled kernels where all are on disk."""

import importlib

from kinetree.tasks.compiled_ahead import is_all_compiled
from kinetree.tasks.numerics.kernel_list import compile_all, lines


def load() -> None:
    """Imports and loads it."""
    importlib.import_module("kinetree.tasks.methods")
    if is_all_compiled():  # else the first worker would wait until all are
        compile_all(lines(), lambda: True)
