"""What runs leave in the store: which nodes they used, so that a later plan can say what changed and gc what is needed."""

import os
import secrets
import socket
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from kinetree.pipeline.config import Config
from kinetree.pipeline.events import Account
from kinetree.pipeline.execute import versions
from kinetree.pipeline.node import Node, label
from kinetree.pipeline.reason import Recalled
from kinetree.pipeline.schedule import Schedule
from kinetree.pipeline.store import Store

FORMAT = "kinetree.run/1"
ABANDONED_SECONDS = 24 * 3600.0
"""After this a run on another machine, of which nothing is known, counts as killed."""
LOOKED_BACK = 50
"""Runs whose records a plan reads to say what changed."""
TASK_FIELDS = ("ran", "fresh", "failed", "seconds")
FAILURE_FIELDS = ("node", "error", "message")


@dataclass
class History:
    """The runs of one store, seen from one output folder."""

    store: Store
    output: str
    _nodes: dict[str, Any] | None = None

    def recall(self, node: str) -> Recalled:
        """What the node computed in the last run that is on record, of the same output folder if there is one."""
        key = (self.last_nodes().get(node) or {}).get("key")
        if not key:
            return "nothing"
        return self.store.record(key) or "lost"

    def runs(self) -> list[dict[str, Any]]:
        """Every run on record without its nodes, oldest first; one that never ended and is not under way was killed."""
        runs = [self.store.run(name) for name in self.store.run_names()]
        for run in runs:
            if run["status"] == "running" and not is_under_way(run):
                run["status"] = "killed"
        return [{name: value for name, value in run.items() if name not in ("nodes", "uses")} for run in runs]

    def last_nodes(self) -> dict[str, Any]:
        """Every node that the last runs into this folder computed, as the newest of them did; of any folder if none did."""
        if self._nodes is None:
            runs = [self.store.run(name) for name in self.store.run_names()[-LOOKED_BACK:]]
            mine = [run for run in runs if run.get("output") == self.output and run.get("nodes")]
            self._nodes = {}
            for run in mine or runs:
                self._nodes |= {name: node for name, node in run.get("nodes", {}).items() if node.get("key")}
        return self._nodes


def new_name() -> str:
    """A run's name: its start in UTC to the thousandth, so that names sort by age, and two digits against twins."""
    now = datetime.now(UTC)
    return f"{now:%Y%m%d-%H%M%S}-{now.microsecond // 1000:03d}{secrets.token_hex(1)}"


def is_under_way(run: dict[str, Any]) -> bool:
    """Whether a run on record is still being computed, as far as this machine can know."""
    if run["status"] != "running":
        return False
    if run["host"] == socket.gethostname():
        try:
            os.kill(int(run["pid"]), 0)
        except ProcessLookupError:
            return False
        except PermissionError:
            return True
        return True
    return time.time() - float(run["epoch"]) < ABANDONED_SECONDS


def opening(name: str, config: Config, schedule: Schedule) -> dict[str, Any]:
    """The record of a run that has begun; `uses` are the keys it found fresh, so that nobody frees them meanwhile."""
    return {
        "format": FORMAT,
        "name": name,
        "status": "running",
        "started": datetime.now(UTC).isoformat(timespec="milliseconds"),
        "epoch": time.time(),
        "host": socket.gethostname(),
        "pid": os.getpid(),
        "output": str(config.output),
        "config": config.saved(),
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
    for task, members in schedule.given.items():
        over = schedule.graph.by_name[task].over
        for index, artifact in members.items():
            nodes[label(Node(task, index), over)]["values"] = artifact.plain()
    asked = {task.name for task in schedule.graph.tasks}
    left = {name: {**node, "state": "left"} for name, node in before.items() if name.partition("[")[0] not in asked}
    nodes = {**left, **nodes}
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
