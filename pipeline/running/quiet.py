"""Keeps dask's own log away from the terminal while a run speaks for it."""

import contextlib
import logging
import threading
from collections.abc import Iterator, Mapping

LOUD = ("distributed", "distributed.client", "distributed.nanny", "distributed.scheduler")
"""Loggers of dask's that write a page where a worker is killed."""
_SILENCING = threading.Lock()
_LEVELS: list[Mapping[str, int]] = []
"""Of these loggers, as every run that is quiet found them, in the order of their beginnings."""


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """A worker that was killed is our message to give, not a page of the library's log; the last run of this program that
    is quiet gives the loggers back the levels that the first one found.
    """
    with _SILENCING:
        _LEVELS.append({name: logging.getLogger(name).level for name in LOUD})
        for name in LOUD:
            logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        with _SILENCING:
            before = _LEVELS.pop()
            if not _LEVELS:
                for name, level in before.items():
                    logging.getLogger(name).setLevel(level)
