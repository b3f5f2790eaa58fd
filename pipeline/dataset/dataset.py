"""A data set as a program sees it: many sequences with one configuration, planned, run and summed up together.

dataset = Dataset.of("lab.yaml")
dataset.plan()                            each sequence new, changed, fresh or failed last time
dataset.run()                             computes what is out of date, in one window, and the summary
dataset.table()                           the summary's rows
dataset["walk_07"]                        the Pipeline of one sequence
"""

import contextlib
import json
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from kinetree.errors import ConfigError, InputError, KinetreeError, StoreError, UnknownNodeError
from kinetree.pipeline import views
from kinetree.pipeline.application import Application, current
from kinetree.pipeline.dataset import dataset_config
from kinetree.pipeline.dataset.dataset_config import DatasetConfig
from kinetree.pipeline.dataset.dataset_plan import DatasetPlan, PlannedSequence, planned, rate
from kinetree.pipeline.dataset.hook import called
from kinetree.pipeline.dataset.lease import Leases, holder
from kinetree.pipeline.dataset.metrics import Metrics
from kinetree.pipeline.dataset.night import Night, input_changed, now
from kinetree.pipeline.dataset.rotation import RotatingLog
from kinetree.pipeline.dataset.sequences import chosen, frames_taken_for_sequences
from kinetree.pipeline.dataset.since import epoch
from kinetree.pipeline.dataset.summing import Summing
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.history import Heads, History
from kinetree.pipeline.inspection.look import Table
from kinetree.pipeline.output.outcome import OUTCOME, Outcome
from kinetree.pipeline.output.ownership import Owned
from kinetree.pipeline.running.events import Listener
from kinetree.pipeline.running.worker_parent import refuse_within_import
from kinetree.pipeline.running.workers import Workers, refuse_no_client
from kinetree.pipeline.settings.config import Compute
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.gc import advising, collect
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.sizes import bytes_of
from kinetree.pipeline.storage.store import Store
from kinetree.pipeline.suggest import nearest

SUMMARY = "dataset.json"
"""What the last run over the data set did, in the data set's folder."""
LOG = "dataset.log"
FORMAT = "kinetree.dataset/1"
ROOT_SECONDS = 120.0
"""How long a run waits for another one that is making the same summary."""


@dataclass(frozen=True)
class Dataset:
    """Sequences with one configuration and one store; making one computes nothing."""

    config: DatasetConfig
    application: Application
    store: Store

    @staticmethod
    def of(
        target: str | Path | Mapping[str, Any],
        *,
        sets: Iterable[str] = (),
        application: Application | None = None,
    ) -> "Dataset":
        """The data set of a YAML file or a mapping.

        sets        : overrides for all sequences as task.name=value
        application : the product; None takes the one whose command line is running or else the one that is installed
        raises      : ConfigError, StoreError
        """
        product = application or current()
        config = dataset_config.load(target, product, sets)
        return Dataset(config, product, Store.at(config.store))

    def computed_by(self, compute: Compute) -> "Dataset":
        """The same computed elsewhere or wider."""
        return replace(self, config=dataset_config.with_compute(self.config, compute))

    def __getitem__(self, name: str) -> Pipeline:
        """The pipeline of one sequence; raises UnknownNodeError with the nearest name."""
        if name not in self.config.sequences:
            raise UnknownNodeError(f"no sequence {name!r}; {nearest(name, self.config.sequences)}")
        config = self.config.sequences[name]
        graph = replace(self.application.methods()[config.method], renamed=self.application.renamed)
        return Pipeline(config, graph, self.store)

    def __iter__(self) -> Iterator[str]:
        return iter(self.config.sequences)

    def __len__(self) -> int:
        return len(self.config.sequences)

    def __repr__(self) -> str:
        return f"Dataset({len(self)} sequences; {self.config.root}, store {self.store.url})"

    def outcomes(self) -> dict[str, Outcome | None]:
        """What the last run of every sequence left; None where there was none."""
        return {name: Outcome.at(config.output) for name, config in self.config.sequences.items()}

    def last_record(self) -> dict[str, Any] | None:
        """What dataset.json holds; None where there is none that can be read."""
        try:
            return dict(json.loads((self.config.root / SUMMARY).read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None

    def plan(self, *, only: Sequence[str] = (), failed: bool = False, since: str | None = None) -> DatasetPlan:
        """What a run would do, by sequence; looks at the input, computes nothing. Arguments as those of `run`."""
        files, heads, before = Files.of(self.store), Heads(self.store), self.outcomes()
        known = rate([outcome for outcome in before.values() if outcome is not None])
        rows = []
        for name in self._selected(only, failed=failed, since=since):
            pipeline = self[name]
            try:
                history = History.of(self.store, pipeline.config, heads)
                there = pipeline.look(files, history, pipeline.tasks.unasked)
            except StoreError:
                raise
            except (InputError, OSError) as error:
                rows.append(PlannedSequence(name, "refused", why=str(error)))
            else:
                rows.append(planned(name, there, before[name], known))
        files.save()
        refused = {row.name for row in rows if row.state == "refused"}
        return DatasetPlan(tuple(rows), (*self.config.notes, *self._frames_hint(refused)))

    def run(
        self,
        client: Any = None,
        *,
        only: Sequence[str] = (),
        failed: bool = False,
        since: str | None = None,
        max_hours: float | None = None,
        listeners: Sequence[Listener] = (),
    ) -> dict[str, Any]:
        """Computes what is out of date, then the summary; returns what dataset.json holds.

        client    : a `distributed.Client` to run on; None runs where the configuration says
        only      : patterns of names; none means all
        failed    : only those that failed last time
        since     : only those whose input changed since a date, or within a time such as 36h or 7d
        max_hours : after this no node is sent any more; the next run goes on
        raises    : StoreError, ClusterError where going on makes no sense, after what became of all was put on record
        """
        refuse_no_client(client)
        if client is None:
            self._refuse_within_import()
        started, began = time.perf_counter(), now()
        selected = self._selected(only, failed=failed, since=since)
        Owned.of(self.config.root).claim([SUMMARY, LOG, OUTCOME])
        log = RotatingLog(self.config.root / LOG, bytes_of(self.config.retention.log_size), self.config.retention.logs)
        record: dict[str, Any] = {"format": FORMAT, "file": self.config.file, "status": "stopped", "started": began}
        metrics = Metrics.of(self.config.metrics, self.application.name) if self.config.metrics is not None else None
        until = None if max_hours is None else time.monotonic() + 3600 * max_hours
        helpers = {"beside": self.application.beside, "setup": self.application.worker_setup}
        workers_of_all = Workers(self.config.compute, client, **helpers)
        with contextlib.closing(log), Leases() as leases, workers_of_all as workers, advising(self.store):
            summing = Summing.of(self.config, self.application, self.store)
            night = Night(
                {name: self[name] for name in selected},
                dict(self.config.inputs),
                summing.linked if summing is not None else (),
                leases,
                (log, *([metrics] if metrics is not None else []), *listeners),
                lambda: until is not None and time.monotonic() >= until,
            )
            try:
                self._compute(night, workers)
                if summing is not None and leases.wait_for(self.config.root, ROOT_SECONDS):
                    outcome, _ = summing.make(workers)
                    record["summary"] = {
                        "status": outcome.status,
                        "files": sorted(outcome.files),
                        "failures": outcome.failures,
                    }
                record["status"] = "failed" if _has_failed(night, record) else "done"
                if self.config.retention.deletes:
                    record["deleted"] = self._collect()
            except KeyboardInterrupt:
                record["status"] = "interrupted"
                raise
            except KinetreeError as error:
                record["error"] = f"{type(error).__name__}: {error}"
                raise
            finally:
                record |= {"ended": now(), "seconds": round(time.perf_counter() - started, 3), **self._described(night)}
                if metrics is not None:
                    record |= metrics.write(record)
                self._leave(record)
        return record

    def report(self) -> dict[str, Any]:
        """Brings the summary up to date with what the sequences' last runs left, and computes nothing else.

        returns : its status and the paths of its files
        raises  : ConfigError where the application makes no summary
        """
        self._refuse_within_import()
        Owned.of(self.config.root).claim([OUTCOME])
        with Leases() as leases, Workers(self.config.compute) as workers:
            summing = self._summing()
            if not leases.wait_for(self.config.root, ROOT_SECONDS):
                raise ConfigError(f"{self.config.root}: another process has been making the summary for {ROOT_SECONDS:g} s")
            outcome, _ = summing.make(workers)
        files = [str(self.config.root / name) for name in sorted(outcome.files)]
        return {"status": outcome.status, "files": files, "failures": list(outcome.failures)}

    def _refuse_within_import(self) -> None:
        if self.config.compute.has_own_workers:
            refuse_within_import()

    def table(self) -> Table:
        """The rows of the summary, as what the sequences' last runs left makes them now."""
        with Workers(Compute(executor="sync")) as workers:
            return Table(views.rows(self._summing().artifact(workers)))

    def status(self) -> Table:
        """What became of every sequence in its last run, and which are being computed now; computes nothing."""
        rows = []
        for name, outcome in self.outcomes().items():
            process = holder(self.config.sequences[name].output)
            running = f"running: process {process['pid']} on {process['host']}" if process else ""
            first = outcome.failures[0] if outcome is not None and outcome.failures else {}
            rows.append(
                {
                    "name": name,
                    "status": running or (outcome.status if outcome is not None else "new"),
                    "ended": outcome.ended if outcome is not None else "",
                    "seconds": outcome.seconds if outcome is not None else None,
                    "failures": len(outcome.failures) if outcome is not None else 0,
                    "why": f"{first.get('node', '')} {first.get('message', '')}".strip(),
                }
            )
        return Table(rows)

    def _compute(self, night: Night, workers: Workers) -> None:
        try:
            first = night.begin()
            if first is not None:
                night.put_back(first)
                workers.run(night, self.store)
        except KeyboardInterrupt:
            night.give_up("interrupted")
            raise
        except BaseException:
            night.give_up("stopped")
            raise
        night.give_up("interrupted")  # what the time did not suffice for
        night.save()

    def _summing(self) -> Summing:
        summing = Summing.of(self.config, self.application, self.store)
        if summing is None:
            raise ConfigError(f"{self.application.name} makes no summary of data sets")
        return summing

    def _selected(self, only: Sequence[str], *, failed: bool, since: str | None) -> list[str]:
        names = chosen(self.config.sequences, only)
        if failed:
            before = self.outcomes()
            names = [name for name in names if (one := before[name]) is not None and one.status == "failed"]
        if since is not None:
            begin = epoch(since)
            names = [name for name in names if input_changed(self.config.inputs[name]) >= begin]
        return names

    def _collect(self) -> dict[str, Any]:
        policy = self.config.retention
        size = None if policy.max_size is None else bytes_of(policy.max_size)
        garbage = collect(self.store, last=policy.keep_last, days=policy.keep_days, size=size)
        return {"runs": len(garbage.runs), "artifacts": len(garbage.artifacts), "bytes": garbage.bytes}

    def _frames_hint(self, refused: set[str]) -> list[str]:
        """What is to be said where no sequence at all could be read."""
        return frames_taken_for_sequences(self.config.inputs) if refused == set(self.config.inputs) else []

    def _described(self, night: Night) -> dict[str, Any]:
        sequences = {}
        for name, state in sorted(night.states.items()):
            outcome = night.outcomes.get(name)
            row: dict[str, Any] = {"state": state, "output": str(self.config.sequences[name].output)}
            if outcome is not None:
                row |= {"run": outcome.run, "seconds": outcome.seconds, "remarks": len(outcome.remarks)}
                row |= {"failures": [dict(failure) for failure in outcome.failures]}
            if name in night.reasons:
                row["why"] = night.reasons[name]
            sequences[name] = row
        states = list(night.states.values())
        counts = {state: states.count(state) for state in ("ran", "fresh", "failed", "elsewhere", "left")}
        refused = {name for name, outcome in night.outcomes.items() if outcome.status == "failed" and not outcome.run}
        notes = [*self.config.notes, *self._frames_hint(refused)]
        return {"counts": counts, "sequences": sequences, "notes": notes}

    def _leave(self, record: dict[str, Any]) -> None:
        """Leaves dataset.json and, where something failed, hands its path to the program that is to hear of it."""
        is_bad = record["status"] in ("failed", "stopped")
        text = json.dumps(record, indent=2, ensure_ascii=False, default=str)
        folder = Folder(self.config.root, "output folder", beside="")
        with contextlib.suppress(StoreError) if record["status"] == "stopped" else contextlib.nullcontext():
            folder.put(SUMMARY, f"{text}\n".encode("utf-8", "backslashreplace"))
        if is_bad and self.config.on_failure:
            record["on_failure"] = called([*self.config.on_failure, str(self.config.root / SUMMARY)])


def _has_failed(night: Night, record: Mapping[str, Any]) -> bool:
    return "failed" in night.states.values() or record.get("summary", {}).get("status", "done") != "done"
