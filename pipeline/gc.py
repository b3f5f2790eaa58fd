"""Frees what no kept run needs: records, artifacts, and what writers that died left half-written."""

import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from kinetree.pipeline.heartbeat import lives
from kinetree.pipeline.store import Store, artifact_path

LEFTOVER_SECONDS = 24 * 3600.0
"""After this nobody is writing what lies half-written."""


@dataclass(frozen=True)
class Garbage:
    """What a collection frees or, dry, would free."""

    runs: tuple[str, ...]
    records: tuple[str, ...]
    artifacts: tuple[str, ...]
    leftovers: tuple[str, ...]
    bytes: int

    def __str__(self) -> str:
        mib = self.bytes / 2**20
        return (
            f"{len(self.artifacts)} artifacts, {len(self.records)} records, {len(self.runs)} runs,"
            f" {len(self.leftovers)} incomplete files: {mib:.1f} MiB"
        )

    def json(self) -> dict[str, Any]:
        """As JSON values."""
        names = ("runs", "records", "artifacts", "leftovers")
        return {**{name: list(getattr(self, name)) for name in names}, "bytes": self.bytes}


def collect(store: Store, *, keep: Collection[str] = (), last: int | None = None, dry: bool = False) -> Garbage:
    """Removes what none of the kept runs used: those named in `keep`, and the last ones of each output folder.

    keep   : names of runs; raises UnknownNodeError for one that is not on record
    last   : how many runs of each output folder to keep; None keeps 1 where `keep` is empty, else none
    dry    : only says what would go
    A run that is under way, here or on another machine, keeps what it found fresh when it began and everything that was
    made since; so does one that was killed, until a later run into the same folder has taken its work over.
    """
    runs = {name: store.run(name) for name in store.run_names()}
    for name in keep:
        store.run(name)
    count = last if last is not None else (0 if keep else 1)
    unfinished = [run for run in _latest(runs) if not run["nodes"]] + [
        run for run in runs.values() if run["status"] == "running" and lives(run, store)
    ]
    needed = {*keep, *_last(runs, count), *(run["name"] for run in unfinished)}
    keys = {node["key"] for name in needed for node in runs[name]["nodes"].values() if node.get("key")}
    keys.update(key for name in needed for key in runs[name].get("uses", ()))
    since = min((run["epoch"] for run in unfinished), default=float("inf"))
    garbage = _garbage(store, tuple(name for name in runs if name not in needed), keys, since)
    if not dry:
        _free(store, garbage)
    return garbage


def _last(runs: dict[str, dict[str, Any]], count: int) -> list[str]:
    by_output: dict[str, list[str]] = {}
    for name, run in runs.items():
        if run["nodes"]:
            by_output.setdefault(run["output"], []).append(name)
    return [name for names in by_output.values() for name in (names[-count:] if count else ())]


def _latest(runs: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
    """The last run of each output folder."""
    return list({run["output"]: run for run in runs.values()}.values())


def _garbage(store: Store, runs: tuple[str, ...], keys: Collection[str], since: float) -> Garbage:
    records: list[str] = []
    needed: set[str] = set()
    for shard in store.place.names("records"):
        for name in store.place.names(f"records/{shard}"):
            key = name.removesuffix(".json")
            record = store.record(key)
            young = store.place.modified(f"records/{shard}/{name}") >= since
            if record is not None and (key in keys or young):
                needed.add(record.artifact)
            else:
                records.append(key)
    artifacts: list[str] = []
    freed = 0
    for shard in store.place.names("artifacts"):
        for digest in store.place.names(f"artifacts/{shard}"):
            if digest not in needed and store.place.modified(artifact_path(digest)) < since:
                artifacts.append(digest)
                freed += sum(store.place.tree(artifact_path(digest)).values())
    old = time.time() - LEFTOVER_SECONDS
    leftovers = tuple(name for name in store.place.names("tmp") if store.place.modified(f"tmp/{name}") < min(old, since))
    freed += sum(sum(store.place.tree(f"tmp/{name}").values()) for name in leftovers)
    return Garbage(runs, tuple(records), tuple(artifacts), leftovers, freed)


def _free(store: Store, garbage: Garbage) -> None:
    """Records go before artifacts, so that no record ever names what is not there."""
    paths: list[Sequence[str]] = [
        [f"runs/{name}.json" for name in garbage.runs],
        [f"records/{key[:2]}/{key}.json" for key in garbage.records],
        [artifact_path(digest) for digest in garbage.artifacts],
        [f"tmp/{name}" for name in garbage.leftovers],
    ]
    for group in paths:
        for path in group:
            store.place.remove(path)
