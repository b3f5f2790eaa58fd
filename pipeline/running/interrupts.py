"""Ctrl-C and SIGTERM as something a loop receives, so that it stops where it is at rest."""

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from typing import NoReturn

_heard = threading.Event()
"""Whether a signal came that `heed` listens for."""


def heed() -> None:
    """From now on SIGTERM, and Ctrl-C where this process does not ignore it, raise KeyboardInterrupt."""
    _heard.clear()
    signal.signal(signal.SIGTERM, _interrupt)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)


def is_interrupted() -> bool:
    """Whether a signal came that `heed` listens for, though a library may have passed over it, and no run has begun since."""
    return _heard.is_set()


def raise_swallowed() -> None:
    """Raises KeyboardInterrupt where a signal came before that a library passed over.

    Libraries try to import others and pass over whatever is raised meanwhile.
    """
    if _heard.is_set():
        _heard.clear()  # a later run of this process is not meant
        raise KeyboardInterrupt


def _interrupt(*_: object) -> NoReturn:
    _heard.set()
    raise KeyboardInterrupt


@contextlib.contextmanager
def interruptible(interrupt: Callable[..., None], *, is_apart: bool) -> Iterator[None]:
    """Calls `interrupt` on Ctrl-C and SIGTERM until the block ends.

    Raised wherever the thread happens to be, they can leave a lock of a library held for ever. A node that runs in this
    very thread (not `is_apart`) is interrupted as usual. A signal that whoever started this process had it ignore (nohup, a
    job in the background) stays ignored.

    raises : KeyboardInterrupt as `raise_swallowed`
    """
    raise_swallowed()
    if not is_apart or threading.current_thread() is not threading.main_thread():
        yield
        return
    heeded = [n for n in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(n) is not signal.SIG_IGN]
    before = {number: signal.signal(number, interrupt) for number in heeded}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)
