"""The summary of a data set: a graph of its own over the dimension `sequence`, whose beginnings the sequences' runs made."""

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from kinetree.errors import GraphError
from kinetree.pipeline.application import Application
from kinetree.pipeline.dataset.dataset_config import DatasetConfig
from kinetree.pipeline.dataset.night import now
from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.inspection.history import Heads, History
from kinetree.pipeline.inspection.origins import origin_artifacts
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.pipeline.output.outcome import Outcome, computing_seconds, stamps
from kinetree.pipeline.output.session import Session
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.running.events import Watch
from kinetree.pipeline.running.jobs import Job, Single
from kinetree.pipeline.running.workers import Workers
from kinetree.pipeline.settings.config import Config
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store, artifact_path
from kinetree.schemas.array import Artifact


@dataclass(frozen=True)
class Summing:
    """The graph that sums up a data set, with what it begins with; all it knows is read from the outcomes of sequences."""

    dataset: DatasetConfig
    graph: Graph
    store: Store

    @staticmethod
    def of(dataset: DatasetConfig, application: Application, store: Store) -> "Summing | None":
        """The summary that an application makes of data sets; None where it makes none."""
        return Summing(dataset, application.data_sets(), store) if application.data_sets is not None else None

    @cached_property
    def linked(self) -> tuple[AnyTask, ...]:
        """The tasks whose artifacts the sequences make."""
        return tuple(task for task in self.graph.tasks if task.is_linked)

    @property
    def last(self) -> AnyTask:
        """The task that writes the summary."""
        return self.graph.tasks[-1]

    def look(self) -> Snapshot:
        """What there is of the summary and what is out of date, by what the sequences' last runs left."""
        rows, links = self._rows()
        config = self._config(rows)
        history = History.of(self.store, config, Heads(self.store))
        given, _ = origin_artifacts(self.graph, config, Files(self.store), history)
        schedule = Schedule(self.graph, config.params, self.store, given, recall=history.recall, links=links)
        return Snapshot(schedule, history)

    def make(self, workers: Workers) -> tuple[Outcome, bool]:
        """Brings the summary up to date in the data set's folder; returns what became of it and whether anything was done.

        raises : StoreError, ClusterError
        """
        there, folder = self.look(), self.dataset.root
        before = Outcome.at(folder)
        if before is not None and before.is_done and there.plan.is_done and before.is_untouched(folder):
            return before, False
        session = Session.begin(self._config(self._rows()[0]), there, started=time.perf_counter(), is_own=False)
        status = "stopped"
        try:
            job = Job(there.schedule, session.watch)
            if not job.is_idle:
                workers.run(Single(job), self.store)
            status = session.leave()
        finally:
            summed = session.close(status)  # type: ignore[arg-type]
        session.write_pages(summed)
        ending = "done" if status == "done" else "failed"
        files = stamps(folder, session.left) if ending == "done" else {}
        failures = tuple({key: f[key] for key in ("node", "error", "message")} for f in session.account.failures)
        seconds, counts = computing_seconds(there.schedule), session.account.nodes()
        outcome = Outcome("", "", ending, now(), session.name, seconds, 0, counts, failures, files=files)  # type: ignore[arg-type]
        outcome.write(folder)
        return outcome, True

    def artifact(self, workers: Workers) -> Artifact:
        """The summary as it is now; what is out of date of it is computed, and no run is put on record."""
        there = self.look()
        job = Job(there.schedule, Watch())
        if not job.is_idle:
            self.store.create()
            workers.run(Single(job), self.store)
        return there.artifact(self.last.returns)

    def _config(self, rows: list[dict[str, Any]]) -> Config:
        origins = [task for task in self.graph.tasks if task.is_origin and not task.is_linked]
        if len(origins) != 1 or origins[0].params is None:
            raise GraphError(f"the graph over data sets has {len(origins)} origins; expected one, with params")
        params: dict[str, Any] = {task.name: task.sets() for task in self.graph.tasks if task.sets and not task.is_origin}
        params[origins[0].name] = origins[0].params.model_validate({"sequences": rows})
        return Config("data set", params, self.dataset.root, self.dataset.store, self.dataset.compute)

    def _rows(self) -> tuple[list[dict[str, Any]], Mapping[str, Mapping[tuple[int, ...], str]]]:
        """What became of every sequence, and the artifacts of those that were computed and are still there."""
        rows: list[dict[str, Any]] = []
        links: dict[str, dict[tuple[int, ...], str]] = {task.name: {} for task in self.linked}
        for number, (name, config) in enumerate(self.dataset.sequences.items()):
            outcome = Outcome.at(config.output)
            artifacts = outcome.artifacts if outcome is not None else {}
            has_result = bool(artifacts) and all(self._holds(artifacts.get(task.name)) for task in self.linked)
            if has_result:
                for task in self.linked:
                    links[task.name][number,] = artifacts[task.name]
            rows.append(
                {
                    "name": name,
                    "output": os.path.relpath(config.output, self.dataset.root),
                    "method": config.method,
                    "status": outcome.status if outcome is not None else "new",
                    "seconds": outcome.seconds if outcome is not None else 0.0,
                    "remarks": outcome.remarks if outcome is not None else (),
                    "failures": [_failure(f) for f in outcome.failures] if outcome is not None else (),
                    "files": sorted(outcome.files) if outcome is not None else (),
                    "has_result": has_result,
                }
            )
        return rows, links

    def _holds(self, digest: str | None) -> bool:
        return digest is not None and self.store.place.size(artifact_path(digest)) is not None


def _failure(failure: Mapping[str, str]) -> str:
    node = f"{failure['node']}: " if failure.get("node") else ""
    return f"{node}{failure.get('error')}: {failure.get('message')}"
