"""Ctrl-C and SIGTERM as something a loop receives, so that it stops where it is at rest."""

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def interruptible(interrupt: Callable[..., None], *, is_apart: bool) -> Iterator[None]:
    """Calls `interrupt` on Ctrl-C and SIGTERM until the block ends.

    Raised wherever the thread happens to be, they can leave a lock of a library held for ever. A node that runs in this
    very thread (not `is_apart`) is interrupted as usual. A signal that whoever started this process had it ignore (nohup, a
    job in the background) stays ignored.
    """
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
