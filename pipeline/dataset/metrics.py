"""What a run over a data set did, as metrics in Prometheus' text format, for the textfile collector of its node exporter."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from kinetree.errors import ConfigError

OUTCOMES = {"finish": "ran", "fresh": "fresh", "failed": "failed", "skipped": "skipped"}
"""What an event of a node counts as."""


@dataclass
class Metrics:
    """A listener that counts nodes by task, and a file that is replaced when the run is over."""

    path: Path
    prefix: str
    """Of all names, as metrics of one program have it."""
    nodes: Counter[tuple[str, str]] = field(default_factory=Counter)
    """By task and outcome."""
    seconds: Counter[str] = field(default_factory=Counter)
    """Of computing, by task."""

    @staticmethod
    def of(path: Path, prefix: str) -> "Metrics":
        """Raises ConfigError where the package that writes them is not installed."""
        try:
            import prometheus_client  # noqa: F401
        except ImportError:
            raise ConfigError(
                "metrics needs a package that is not installed: pip install 'kinetree[metrics]', or remove the key metrics"
            ) from None
        return Metrics(path, prefix)

    def hear(self, event: dict[str, Any]) -> None:
        """Counts an event."""
        outcome = OUTCOMES.get(event["event"])
        if outcome is not None:
            self.nodes[event["task"], outcome] += 1
            self.seconds[event["task"]] += event.get("seconds", 0.0)

    def write(self, record: Mapping[str, Any]) -> dict[str, str]:
        """Replaces the file by what a run tells; returns its path, or why it could not be written, for dataset.json."""
        from prometheus_client import CollectorRegistry, Gauge, write_to_textfile

        registry = CollectorRegistry()
        of_set = {"data_set": Path(record["file"]).name}

        def gauge(name: str, what: str, rows: Mapping[Any, float], *labels: str) -> None:
            metric = Gauge(f"{self.prefix}_{name}", what, (*of_set, *labels), registry=registry)
            for values, value in rows.items():
                metric.labels(*of_set.values(), *values).set(value)

        ended = datetime.fromisoformat(record["ended"]).timestamp()
        gauge("dataset_success", "Whether the last run did all it was asked for.", {(): record["status"] == "done"})
        gauge("dataset_ended_timestamp_seconds", "When the last run was over.", {(): ended})
        gauge("dataset_duration_seconds", "How long the last run took.", {(): record["seconds"]})
        counts = {(state,): count for state, count in record["counts"].items()}
        gauge("dataset_sequences", "Sequences by what the last run did with them.", counts, "state")
        failed = {(name,): 1 for name, row in record["sequences"].items() if row["state"] == "failed"}
        gauge("dataset_sequence_failed", "1 for each sequence that failed in the last run.", failed, "name")
        gauge("dataset_nodes", "Nodes of the last run by what became of them.", self.nodes, "task", "outcome")
        seconds = {(task,): took for task, took in self.seconds.items()}
        gauge("dataset_node_seconds", "Seconds of computing in the last run.", seconds, "task")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            write_to_textfile(str(self.path), registry)
        except OSError as error:
            return {"metrics_error": f"metrics {self.path}: cannot be written: {error.strerror}"}
        return {"metrics": str(self.path)}
