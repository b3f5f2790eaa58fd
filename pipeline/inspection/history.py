"""What runs leave in the store: which nodes they used, so that a later plan can say what changed and gc what is needed."""

import os
import secrets
import time
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from kinetree.pipeline.node import Node, label
from kinetree.pipeline.planning.reason import Recalled
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.running.events import Account
from kinetree.pipeline.running.execute import versions
from kinetree.pipeline.settings.config import Config
from kinetree.pipeline.storage.heartbeat import identity, lives
from kinetree.pipeline.storage.store import Record, Store

FORMAT = "kinetree.run/1"
LOOKED_BACK = 50
"""Runs whose records a plan reads to say what changed."""
TASK_FIELDS = ("ran", "fresh", "failed", "seconds")
FAILURE_FIELDS = ("node", "error", "message")


@dataclass
class Heads:
    """The runs of one store without their nodes, each read once; histories of several output folders may share them."""

    store: Store
    _known: dict[str, dict[str, Any]] = field(default_factory=dict)

    def of(self, output: str) -> list[dict[str, Any]]:
        """The runs into one output folder, oldest first."""
        if not self._known:
            self._known = {head["name"]: head for head in self.store.run_records.heads()}
        for name in self.store.run_records.names():
            if self._known.get(name, {}).get("status", "running") == "running":
                self._known[name] = self.store.run_records.head(name) or {}
        return [self._known[name] for name in sorted(self._known) if self._known[name].get("output") == output]


@dataclass
class History:
    """The runs of one store, seen from one output folder."""

    store: Store
    output: str
    """As `output_name` names it."""
    heads: Heads
    _nodes: dict[str, Any] | None = None
    _runs: list[dict[str, Any]] | None = None

    @staticmethod
    def of(store: Store, config: Config, heads: Heads | None = None) -> "History":
        """The runs of a store as the output folder of a configuration sees them."""
        return History(store, output_name(config), heads or Heads(store))

    def recall(self, node: str) -> Recalled:
        """What the node computed in the last run into this folder that computed it."""
        key = (self.last_nodes().get(node) or {}).get("key")
        if not key:
            return "nothing"
        return self.store.record(key, as_listed=True) or "lost"

    def records(self) -> dict[str, Record]:
        """By label, the records that are still there of the nodes that the last runs computed."""
        recalled = {label: self.recall(label) for label in self.last_nodes()}
        return {label: record for label, record in recalled.items() if isinstance(record, Record)}

    def runs(self) -> list[dict[str, Any]]:
        """Every run on record without its nodes, oldest first; one that never ended and is not under way was killed."""
        runs = self.store.run_records.heads()
        for run in runs:
            if run["status"] == "running" and not lives(run, self.store):
                run["status"] = "killed"
        return [{name: value for name, value in run.items() if name not in ("states", "uses", "list")} for run in runs]

    def last_nodes(self) -> dict[str, Any]:
        """Every node that the last runs into this folder computed, as the newest of them did."""
        if self._nodes is None:
            self._nodes = {}
            newest = {run["list"]: run for run in reversed(self._mine()[-LOOKED_BACK:])}  # of those with one list any will do
            for run in reversed(newest.values()):
                nodes = self.store.run_records.nodes(run) or {}
                self._nodes |= {name: node for name, node in nodes.items() if node.get("key")}
        return self._nodes

    def _mine(self) -> list[dict[str, Any]]:
        if self._runs is None:
            self._runs = self.heads.of(self.output)
        return self._runs

    def origin(self, task: str, params: Any) -> dict[str, Any]:
        """What an origin found in the last run into this folder, its values by node; empty where its parameters differed.

        params : the block of the origin's parameters in the configuration that the run would leave
        """
        for run in reversed(self._mine()):
            listed = self.store.run_records.nodes(run) or {}
            nodes = {n: node["values"] for n, node in listed.items() if "values" in node and n.partition("[")[0] == task}
            if nodes:
                return nodes if run["config"].get(task) == params else {}
        return {}


def new_name() -> str:
    """A run's name: its start in UTC to the thousandth, so that names sort by age, and two digits against twins."""
    now = datetime.now(UTC)
    return f"{now:%Y%m%d-%H%M%S}-{now.microsecond // 1000:03d}{secrets.token_hex(1)}"


def output_name(config: Config) -> str:
    """What a store calls an output folder: by the way to it where the store lies in it and moves with it."""
    is_inside = isinstance(config.store, Path) and config.store.is_relative_to(config.output)
    return os.path.relpath(config.output, config.store) if is_inside else str(Path(config.output))


def opening(name: str, config: Config, schedule: Schedule) -> dict[str, Any]:
    """The record of a run that has begun; `uses` are the keys it found fresh, so that nobody frees them meanwhile."""
    return {
        "format": FORMAT,
        "name": name,
        "status": "running",
        "started": datetime.now(UTC).isoformat(timespec="milliseconds"),
        "epoch": time.time(),
        **identity(),
        "output": output_name(config),
        "config": config.portable(),
        "uses": [entry.key for entry in schedule.entries.values() if entry.state == "fresh" and entry.key],
        "nodes": {},
    }


def closing(
    opened: dict[str, Any], schedule: Schedule, before: dict[str, Any], account: Account, summed: dict[str, Any]
) -> dict[str, Any]:
    """The record of a run that is over; nodes of tasks that it was not asked for are carried on as "left".

    before : the nodes on record before it began
    summed : what run.json holds
    """
    nodes: dict[str, dict[str, Any]] = {
        e.label: {"state": e.state, "key": e.key, "artifact": e.artifact} for e in schedule.entries.values()
    }
    for task, members in schedule.origin_artifacts.items():
        over = schedule.graph.by_name[task].over
        for index, artifact in members.items():
            nodes[label(Node(task, index), over)]["values"] = artifact.plain()
    asked = {task.name for task in schedule.graph.tasks}
    unasked = {name: {**node, "state": "left"} for name, node in before.items() if name.partition("[")[0] not in asked}
    nodes = {**unasked, **nodes}
    more = {"tasks": account.tasks, "failures": account.failures, "counts": summed["nodes"], "nodes": nodes}
    return {**{name: value for name, value in opened.items() if name != "uses"}, **summed, **more}


def summary(account: Account, status: str, seconds: float) -> dict[str, Any]:
    """What run.json holds; the run's record in the store also has peaks of memory, traces and every node."""
    tasks = {task: {name: row[name] for name in TASK_FIELDS} for task, row in account.tasks.items()}
    return {
        "status": status,
        "nodes": account.nodes(),
        "tasks": tasks,
        "failures": [{name: failure[name] for name in FAILURE_FIELDS} for failure in account.failures],
        "seconds": round(seconds, 3),
        "versions": versions(),
    }
