"""Frees what no kept run needs: records, artifacts, and what writers that died left half-written."""

import contextlib
import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from kinetree.errors import KinetreeError, StoreFullError
from kinetree.pipeline.storage.heartbeat import LOST_SECONDS, is_here, lives
from kinetree.pipeline.storage.place import Listed
from kinetree.pipeline.storage.run_records import list_path, run_path
from kinetree.pipeline.storage.store import Store, artifact_path

DAY_SECONDS = 24 * 3600.0
_WORTH_SAYING = 2**16
"""Bytes below which freeing them helps nobody."""
LEFTOVER_SECONDS = DAY_SECONDS
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
            f" {len(self.leftovers)} other files: {mib:.1f} MiB"
        )

    def json(self) -> dict[str, Any]:
        """As JSON values."""
        names = ("runs", "records", "artifacts", "leftovers")
        return {**{name: list(getattr(self, name)) for name in names}, "bytes": self.bytes}


def collect(
    store: Store,
    *,
    keep: Collection[str] = (),
    last: int | None = None,
    days: float | None = None,
    size: int | None = None,
    dry: bool = False,
) -> Garbage:
    """Removes what none of the kept runs used: those named in `keep`, and the last ones of each output folder.

    keep   : names of runs; raises UnknownNodeError for one that is not on record
    last   : how many runs of each output folder to keep; None keeps 1 where `keep` is empty, else none
    days   : runs that began within so many days are kept as well
    size   : of these, named ones apart, the oldest are let go until the artifacts of the rest take no more bytes
    dry    : only says what would go
    A run that is under way, here or on another machine, keeps what it found fresh when it began and everything that was
    made since; so does one that was killed, until a later run into the same folder has taken its work over.
    """
    runs = {head["name"]: head for head in store.run_records.heads()}
    for name in keep:
        store.run(name)
    count = last if last is not None else (0 if keep else 1)
    unfinished = [run for run in _latest(runs) if not run["list"]] + [
        run for run in runs.values() if run["status"] == "running" and lives(run, store)
    ]
    recent = [name for name, run in runs.items() if days is not None and run["epoch"] >= time.time() - days * DAY_SECONDS]
    bound = {*keep, *(run["name"] for run in unfinished)}
    needed = {*bound, *_last(runs, count), *recent}
    if size is not None:
        needed = _fitting(store, {name: runs[name] for name in sorted(needed)}, bound, size)
    lists = {runs[name]["list"]: name for name in sorted(needed)}
    keys = {node["key"] for name in lists.values() for node in _nodes(store, runs[name]).values() if node.get("key")}
    keys.update(key for name in needed for key in runs[name].get("uses", ()))
    since = min((_begun(run) for run in unfinished), default=float("inf"))
    garbage = _garbage(store, tuple(name for name in store.run_names() if name not in needed), keys, lists, since)
    if not dry:
        _free(store, garbage)
    return garbage


def _fitting(store: Store, runs: dict[str, dict[str, Any]], bound: Collection[str], size: int) -> set[str]:
    """The runs without the oldest, as many as it takes until what the rest use is no larger than `size`."""
    used = {name: {n["artifact"] for n in _nodes(store, run).values() if n.get("key")} for name, run in runs.items()}
    sizes = {digest: listed.size for digest, listed in store.artifacts().items()}
    staying = set(runs)
    for name in (name for name in runs if name not in bound):
        if sum(sizes.get(d, 0) for d in set().union(*(used[k] for k in staying)) if d) <= size:
            break
        staying.remove(name)
    return staying


def _last(runs: dict[str, dict[str, Any]], count: int) -> list[str]:
    by_output: dict[str, list[str]] = {}
    for name, run in runs.items():
        if run["list"]:
            by_output.setdefault(run["output"], []).append(name)
    return [name for names in by_output.values() for name in (names[-count:] if count else ())]


@contextlib.contextmanager
def advising(store: Store) -> Iterator[None]:
    """Where the disk is full, says what a collection would free, if it would free anything."""
    try:
        yield
    except StoreFullError as error:
        freed = 0
        with contextlib.suppress(KinetreeError, OSError):
            freed = collect(store, dry=True).bytes
        if freed < _WORTH_SAYING:
            raise
        raise StoreFullError(f"{error}; kinetree gc would free {freed / 2**20:.1f} MiB of the store") from error


def _begun(run: Mapping[str, Any]) -> float:
    """From when on something may be of a run, in the store's time; minus infinity where a clock that was set back hides it."""
    epoch = float(run["epoch"]) - (0.0 if is_here(run) else LOST_SECONDS)  # clocks of two machines differ
    return epoch if epoch <= time.time() else float("-inf")


def _latest(runs: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
    """The last run of each output folder."""
    return list({run["output"]: run for run in runs.values()}.values())


def _nodes(store: Store, run: dict[str, Any]) -> dict[str, Any]:
    return store.run_records.nodes(run) or {}


def _garbage(store: Store, runs: tuple[str, ...], keys: Collection[str], lists: Collection[str], since: float) -> Garbage:
    records: list[str] = []
    needed: set[str] = set()
    known = store.records.listed()  # first: a run under way writes more while these are judged
    singles = store.records.singles()
    recent = store.records.since(since)
    for key in known:
        is_wanted = key in keys or key in recent
        record = (singles.get(key) or store.record(key, as_listed=True)) if is_wanted else None
        if record is not None:
            needed.add(record.artifact)
        else:
            records.append(key)
    there = store.artifacts()
    for key in {*store.records.listed()}.difference(known):  # of these some name bytes that an old run left
        if (record := store.record(key)) is not None:
            needed.add(record.artifact)
    artifacts = [digest for digest, listed in there.items() if digest not in needed and listed.modified < since]
    leftovers = dict(_leftovers(store, runs, lists, since))
    freed = sum(there[digest].size for digest in artifacts) + sum(leftovers.values())
    return Garbage(runs, tuple(records), tuple(artifacts), tuple(leftovers), freed)


def _leftovers(store: Store, runs: Collection[str], lists: Collection[str], since: float) -> Iterator[tuple[str, int]]:
    """What else nobody needs, and its size: half-written things, lists and heartbeats of runs that go."""
    old = min(time.time() - LEFTOVER_SECONDS, since)
    half: dict[str, list[Listed]] = {}
    for name, listed in store.place.listed("tmp").items():
        half.setdefault(f"tmp/{name.partition('/')[0]}", []).append(listed)
    yield from ((path, sum(t.size for t in listed)) for path, listed in half.items() if all(t.modified < old for t in listed))
    for name, listed in store.place.listed("nodes").items():
        if name.removesuffix(".json") not in lists and listed.modified < since:
            yield list_path(name.removesuffix(".json")), listed.size
    beats = ((name, listed) for name, listed in store.place.listed("runs").items() if name.endswith(".beat"))
    yield from ((f"runs/{name}", listed.size) for name, listed in beats if name.removesuffix(".beat") in runs)


def _free(store: Store, garbage: Garbage) -> None:
    """Records go before artifacts, so that no record ever names what is not there."""
    store.place.remove_all(map(run_path, garbage.runs))
    store.records.remove(garbage.records)
    store.place.remove_all(map(artifact_path, garbage.artifacts))
    for path in garbage.leftovers:  # a folder may be among them
        store.place.remove(path)
