"""Frees what no kept run needs: records, artifacts, and what writers that died left half-written."""

import time
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from kinetree.pipeline.heartbeat import lives
from kinetree.pipeline.store import Store, artifact_path, list_path

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
    runs = {run["name"]: run for run in store.runs()}
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
    lists = {name for run in needed for name in runs[run]["lists"].values()}
    garbage = _garbage(store, tuple(name for name in store.run_names() if name not in needed), keys, lists, since)
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


def _garbage(store: Store, runs: tuple[str, ...], keys: Collection[str], lists: Collection[str], since: float) -> Garbage:
    records: list[str] = []
    needed: set[str] = set()
    for key in store.records.listed():
        record = store.record(key)
        if record is not None and (key in keys or store.records.modified(key) >= since):
            needed.add(record.artifact)
        else:
            records.append(key)
    artifacts = [d for d in store.artifacts() if d not in needed and store.place.modified(artifact_path(d)) < since]
    leftovers = tuple(_leftovers(store, runs, lists, since))
    freed = sum(store.place.size(path) or 0 for path in [*map(artifact_path, artifacts), *leftovers])
    return Garbage(runs, tuple(records), tuple(artifacts), leftovers, freed)


def _leftovers(store: Store, runs: Collection[str], lists: Collection[str], since: float) -> Iterator[str]:
    """What nobody needs beside records and artifacts: half-written files, lists and heartbeats of runs that go."""
    old = min(time.time() - LEFTOVER_SECONDS, since)
    yield from (f"tmp/{name}" for name in store.place.names("tmp") if store.place.modified(f"tmp/{name}") < old)
    unused = (list_path(n.removesuffix(".json")) for n in store.place.names("nodes") if n.removesuffix(".json") not in lists)
    yield from (path for path in unused if store.place.modified(path) < since)
    beats = (name for name in store.place.names("runs") if name.endswith(".beat"))
    yield from (f"runs/{name}" for name in beats if name.removesuffix(".beat") in runs)


def _free(store: Store, garbage: Garbage) -> None:
    """Records go before artifacts, so that no record ever names what is not there."""
    for name in garbage.runs:
        store.place.remove(f"runs/{name}.json")
    store.records.remove(garbage.records)
    for path in [*map(artifact_path, garbage.artifacts), *garbage.leftovers]:
        store.place.remove(path)
