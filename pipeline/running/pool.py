"""Threads of this process that take one piece of work after the other, and a new one for each that does not come back.

Those of `concurrent.futures` are waited for when the interpreter ends, and one that is stuck in its work would keep its
place for ever.
"""

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any, ParamSpec

P = ParamSpec("P")
Work = Callable[[], Any]


@dataclass(eq=False)
class Running:
    """One piece of work in a pool, a future of its result."""

    pool: "Pool"
    work: Work
    future: "Future[Any]" = field(default_factory=Future)
    began: float | None = None
    is_given_up: bool = False

    def add_done_callback(self, call: Callable[["Running"], None], /) -> None:
        """Calls when it is done, unless it was given up."""
        self.future.add_done_callback(lambda _: None if self.is_given_up else call(self))

    def result(self) -> Any:
        """The value, or raises."""
        return self.future.result()

    def cancel(self) -> None:
        """Takes it back where it has not begun."""
        self.future.cancel()

    def seconds(self) -> float:
        """How long it has been running; 0 where it has not begun, or has ended."""
        return 0.0 if self.began is None or self.future.done() else time.monotonic() - self.began

    def give_up(self) -> str | None:
        """Nobody waits for it any longer; its thread cannot be ended, another takes its place."""
        if self.future.done():
            return None
        self.is_given_up = True
        self.pool.add()
        return "its thread cannot be ended and goes on until it returns or this process ends"

    def run(self) -> None:
        """In a thread of the pool."""
        self.began = time.monotonic()
        if not self.future.set_running_or_notify_cancel():
            return
        try:
            self.future.set_result(self.work())
        except BaseException as error:  # whoever asks for the result hears of it
            self.future.set_exception(error)


class Pool:
    """So many threads, started when there is work, gone when the process ends."""

    def __init__(self, threads: int) -> None:
        self._threads = threads
        self._started = 0
        self._queue: queue.SimpleQueue[Running | None] = queue.SimpleQueue()

    def submit(self, call: Callable[P, Any], /, *args: P.args, **kwargs: P.kwargs) -> Running:
        """Calls in some thread, in the order of submission."""
        running = Running(self, lambda: call(*args, **kwargs))
        self._queue.put(running)
        if self._started < self._threads:
            self.add()
        return running

    def add(self) -> None:
        """Starts one more thread."""
        self._started += 1
        threading.Thread(target=self._serve, name=f"pool {self._started}", daemon=True).start()

    def close(self) -> None:
        """No thread takes anything more; one that is in the middle of something ends after it."""
        for _ in range(self._started):
            self._queue.put(None)

    def _serve(self) -> None:
        while (running := self._queue.get()) is not None:
            running.run()
            if running.is_given_up:
                return
