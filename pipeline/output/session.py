"""One run of a pipeline on record, from its opening to what it leaves in the output folder."""

import contextlib
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from kinetree.errors import StoreError, StoreFullError
from kinetree.pipeline.inspection.history import History, closing, new_name, opening, summary
from kinetree.pipeline.inspection.run_summary import RunSummary
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.pipeline.output.output import (
    RUN_JSON,
    claim,
    pages,
    summaries,
    write_config,
    write_pages,
    write_results,
    write_run_json,
)
from kinetree.pipeline.output.ownership import Owned
from kinetree.pipeline.planning.entry import DONE
from kinetree.pipeline.running.events import Account, Listener, Watch
from kinetree.pipeline.settings.blocks import SAVED
from kinetree.pipeline.settings.config import Config
from kinetree.pipeline.storage.heartbeat import beating

Status = Literal["done", "failed", "interrupted", "stopped"]
UNRECORDED = "the store cannot be written, so this run, which had nothing to compute, is not on record"


@dataclass
class Session:
    """A run under way. Whoever began it computes its schedule and closes it, whatever happened."""

    config: Config
    there: Snapshot
    watch: Watch
    told_of: Mapping[str, Any]
    """What pages say about the graph and the configuration."""
    is_own: bool
    """Whether it leaves its configuration and run.json, which belong to one sequence."""
    opened: dict[str, Any]
    account: Account
    started: float
    owned: Owned
    """The output folder, in which nothing of somebody else's is replaced."""
    is_on_record: bool = True
    """Whether the store has a record of it: one that cannot be written serves a run that has nothing to compute."""
    left: list[str] = field(default_factory=list)
    _stack: contextlib.ExitStack = field(default_factory=contextlib.ExitStack)

    @staticmethod
    def begin(
        config: Config,
        there: Snapshot,
        listeners: Iterable[Listener] = (),
        *,
        started: float | None = None,
        told_of: Mapping[str, Any] | None = None,
        is_own: bool = True,
    ) -> "Session":
        """Puts the run on record as under way and keeps a heartbeat until it is closed.

        started : on the clock of `time.perf_counter`, when the look at the input began
        raises  : StoreError where the store or the output folder cannot be written, or has files of somebody else's
        """
        store = there.schedule.store
        owned = claim(config, there.schedule, (SAVED, RUN_JSON) if is_own else ())
        opened = opening(new_name(), config, there.schedule)
        is_on_record = _recorded(there, opened)
        if is_own:
            write_config(config)
        account = Account()
        watch = Watch((account, *listeners))
        begun = time.perf_counter() if started is None else started
        session = Session(config, there, watch, told_of or {}, is_own, opened, account, begun, owned, is_on_record)
        if is_on_record:
            session._stack.enter_context(beating(store, opened["name"]))
        watch.begin(opened["name"], there.schedule.entries.values())
        return session

    @property
    def name(self) -> str:
        """The run's name."""
        return str(self.opened["name"])

    def leave(self) -> Status:
        """Leaves files and groups of what was computed; returns what became of the run; raises as `write_results`."""
        self.left += write_results(self.owned, self.there.schedule) + pages(self.there.schedule)
        return "failed" if self.account.failures else "done"

    def close(self, status: Status) -> RunSummary:
        """Puts on record what became of the run, in the store and in run.json."""
        schedule = self.there.schedule
        store, seconds = schedule.store, time.perf_counter() - self.started
        self._stack.close()
        self.watch.end(status, seconds)
        said = [*self.there.notes, *([] if self.is_on_record else [UNRECORDED])]
        notes = {"notes": said} if said else {}
        summed = {**summary(self.account, status, seconds), "files": self.left, **notes}
        results = summaries(schedule)
        content = {**summed, **({"results": results} if results else {})}
        if self.is_own:
            write_run_json(self.config, content)
        if not self.is_on_record:
            return RunSummary({"run": self.name, **content}, self.there)
        before = History.of(store, self.config).last_nodes()
        store.create()  # which somebody may have removed meanwhile
        store.write_run(self.name, closing(self.opened, schedule, before, self.account, summed))
        store.records.pack(self.name, [e.key for e in schedule.entries.values() if e.key and e.state in DONE])
        return RunSummary({"run": self.name, **content}, self.there)

    def write_pages(self, summed: Mapping[str, Any]) -> None:
        """Leaves the pages that also tell of the run, as `close` summed it up."""
        write_pages(self.config.output, self.there.schedule, {**summed, **self.told_of})


def _recorded(there: Snapshot, opened: Mapping[str, Any]) -> bool:
    """Whether the run could be put on record; raises StoreError where it could not and something is to be computed."""
    store = there.schedule.store
    try:
        store.create()
        store.write_run(opened["name"], opened)
    except StoreFullError:
        raise
    except StoreError:
        if not there.schedule.is_idle:
            raise
        return False
    return True
