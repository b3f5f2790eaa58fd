"""What a worker does with a parcel of nodes: check that it runs the planner's code, read, call, publish, report.

Only keys, indices and digests travel; arrays go through the store, and inside one parcel from step to step in memory.
"""

import platform
import socket
import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Literal

from kinetree.errors import DamagedArtifactError, StaleWorkerError, StoreError
from kinetree.pipeline.identity.key import artifact_digest, node_key
from kinetree.pipeline.identity.own_code import code_digest, code_parts
from kinetree.pipeline.planning.made_with import MadeWith
from kinetree.pipeline.running.memory import measured
from kinetree.pipeline.running.sight import Sight
from kinetree.pipeline.running.threads import blas, limited, simd
from kinetree.pipeline.signature import Form
from kinetree.pipeline.storage.remote import brought
from kinetree.pipeline.storage.store import Record, Store
from kinetree.pipeline.task import Task, load
from kinetree.schemas.array import Artifact, Index

LIBRARIES = ("kinetree", "numpy", "scipy", "numba", "trimesh", "zarr", "dask", "pydantic")
Status = Literal["ran", "fresh", "failed", "damaged", "refused", "undone"]


@dataclass(frozen=True)
class Ref:
    """One artifact that a step reads: by digest in the store, as an earlier step's result, or carried along."""

    label: str
    artifact: str | None = None
    step: int | None = None
    carried: Artifact | None = None


@dataclass(frozen=True)
class Input:
    """One argument of a step."""

    argument: str
    form: Form
    reads: tuple[Ref, ...]
    numbers: tuple[int, ...] | None
    """Member numbers of what is read, where the task sees them."""


@dataclass(frozen=True)
class Step:
    """One node to compute."""

    label: str
    task: str
    """module:name of the task."""
    index: Mapping[str, int]
    code: str
    params: Mapping[str, Any]
    inputs: tuple[Input, ...]
    key: str | None
    """The planner's key, where it could know it."""
    force: bool
    distrusted: MadeWith


@dataclass(frozen=True)
class Result:
    """What became of one step."""

    status: Status
    key: str = ""
    artifact: str = ""
    seconds: float = 0.0
    record: Record | None = None
    error: str = ""
    message: str = ""
    trace: str = ""


@dataclass
class _Bench:
    """What the steps of one parcel have made so far."""

    store: Store
    results: list[Result] = field(default_factory=list)
    made: dict[int, Artifact] = field(default_factory=dict)


def execute(store_url: str, steps: tuple[Step, ...], sight: Sight) -> list[Result]:
    """Computes the steps in order, in a process that has proven that it sees the store; in any other the first is refused."""
    try:
        sight.prove(store_url)
    except StoreError as error:
        refused = Result("refused", error=type(error).__name__, message=str(error))
        return [refused, *(Result("undone") for _ in steps[1:])]
    return compute(store_url, steps)


def compute(store_url: str, steps: tuple[Step, ...]) -> list[Result]:
    """Computes the steps in order; a step that fails leaves those that read it undone and the others untouched."""
    bench = _Bench(_store(store_url))
    for number, step in enumerate(steps):
        needed = [ref.step for i in step.inputs for ref in i.reads if ref.step is not None]
        if any(bench.results[n].status not in ("ran", "fresh") for n in needed):
            bench.results.append(Result("undone"))
            continue
        started = time.perf_counter()
        try:
            bench.results.append(_compute(bench, number, step))
        except DamagedArtifactError as error:
            bench.results.append(Result("damaged", artifact=error.digest, message=error.what))
        except (StoreError, StaleWorkerError) as error:
            bench.results.append(Result("refused", error=type(error).__name__, message=str(error)))
        except Exception as error:  # whatever a task raises is that node's failure and no other's
            message = str(error) or type(error).__name__
            trace = traceback.format_exc()
            spent = time.perf_counter() - started
            bench.results.append(Result("failed", "", "", spent, None, type(error).__name__, message, trace))
    return bench.results


def _compute(bench: _Bench, number: int, step: Step) -> Result:
    task = load(step.task)
    here = code_digest(task.module, task.name)
    if here != step.code:
        raise StaleWorkerError(
            f"{step.label}: planned with other code of {task.module} than this worker has"
            f" ({step.code[:12]} planned, {here[:12]} here); install the same kinetree everywhere and restart the workers"
        )
    inputs = [_recorded(bench, i) for i in step.inputs]
    identity = [[i.argument, i.form, record["artifacts"], i.numbers] for i, record in zip(step.inputs, inputs, strict=True)]
    key = node_key(task.name, here, step.params, identity, _asked_index(task, step))
    if step.key is not None and key != step.key:
        raise StaleWorkerError(f"{step.label}: this worker derives another key ({key[:12]}) than was planned ({step.key[:12]})")
    known = None if step.force else bench.store.record(key)
    if known is not None and step.distrusted(known):
        known = None
    if known is not None and bench.store.holds(known):
        return Result("fresh", key, known.artifact, 0.0, known)
    return _run(bench, number, step, task, key, inputs)


def _run(bench: _Bench, number: int, step: Step, task: Task[..., Any], key: str, inputs: list[dict[str, Any]]) -> Result:
    started = time.perf_counter()
    with measured() as peak:
        values = {i.argument: _value(bench, task, i) for i in step.inputs}
        if task.params is not None:
            values["params"] = task.params.model_validate(step.params)
        if task.asks_index:
            values["index"] = _asked_index(task, step)
        with brought(values) as here, limited(task.threads):
            artifact = task(**here)
        if type(artifact) is not task.returns:
            raise TypeError(f"{task.name} returned {type(artifact).__name__}, its signature promises {task.returns.__name__}")
        digest, size = bench.store.publish(artifact)
    bench.made[number] = artifact
    seconds = time.perf_counter() - started
    record = Record(
        key=key,
        task=task.name,
        index=dict(step.index),
        artifact=digest,
        bytes=size,
        params=dict(step.params),
        code=dict(code_parts(task.module, task.name)),
        inputs=inputs,
        seconds=seconds,
        peak_bytes=peak.process,
        own_bytes=peak.own,
        host=socket.gethostname(),
        created=datetime.now(UTC).isoformat(timespec="milliseconds"),
        versions={**versions(), "blas": blas(), "simd": simd()},
        asks_index=task.asks_index,
    )
    bench.store.write(record)
    return Result("ran", key, digest, seconds, record)


def _recorded(bench: _Bench, read_input: Input) -> dict[str, Any]:
    """An argument in the words of a record: argument, form, nodes, artifacts."""
    return {
        "argument": read_input.argument,
        "form": read_input.form,
        "nodes": [ref.label for ref in read_input.reads],
        "artifacts": [_digest(bench, ref) for ref in read_input.reads],
    }


def _digest(bench: _Bench, ref: Ref) -> str:
    if ref.carried is not None:
        return artifact_digest(ref.carried)
    return bench.results[ref.step].artifact if ref.step is not None else str(ref.artifact)


def _asked_index(task: Task[..., Any], step: Step) -> Index | None:
    return tuple(step.index[dim] for dim in task.over) if task.asks_index else None


def _value(bench: _Bench, task: Task[..., Any], read_input: Input) -> Any:
    cls = next(a.artifact for a in task.arguments if a.name == read_input.argument)
    artifacts = [_artifact(bench, cls, ref) for ref in read_input.reads]
    if read_input.form == "tuple":
        return tuple(artifacts)
    if read_input.numbers is not None:
        return dict(zip(read_input.numbers, artifacts, strict=True))
    return artifacts[0] if artifacts else None


def _artifact(bench: _Bench, cls: type[Artifact], ref: Ref) -> Artifact:
    if ref.carried is not None:
        return ref.carried
    if ref.step is not None and ref.step in bench.made:
        return bench.made[ref.step]
    return _read(bench.store.url, cls, _digest(bench, ref))


def forget_reads() -> None:
    """Lets go of what was read: a run that begins must see what lies in the store now."""
    _read.cache_clear()
    _store.cache_clear()


@lru_cache(maxsize=16)
def _read(url: str, cls: type[Artifact], digest: str) -> Artifact:
    """What many nodes read in turn, such as the one template of all frames, is read and checked once."""
    return _store(url).read(cls, digest)


@lru_cache(maxsize=8)
def _store(url: str) -> Store:
    return Store.at(url)


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Versions of Python and of the libraries that took part."""
    by_library = {"python": platform.python_version()}
    for name in LIBRARIES:
        try:
            by_library[name] = version(name)
        except PackageNotFoundError:
            continue
    return by_library
