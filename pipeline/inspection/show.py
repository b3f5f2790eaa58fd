"""One node for a person: its schema with shapes and statistics, and where it comes from."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import KinetreeError
from kinetree.pipeline import views
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.pipeline.settings.sentences import sentences
from kinetree.pipeline.storage.store import Record
from kinetree.schemas.array import Array, Artifact


def node_details(pipeline: Pipeline, node: str) -> dict[str, Any]:
    """State, schema, arrays with statistics, values and provenance of one node, as JSON values.

    raises : UnknownNodeError
    """
    there = pipeline.inspect()
    entry, planned = there.entry(node), there.why(node)
    content = {"node": entry.label, "state": planned.state, "why": str(planned), "schema": _schema(entry.task.returns)}
    if entry.artifact is None:
        return content
    artifact = there.schedule.value(entry.node)
    return {
        **content,
        "artifact": entry.artifact,
        "told": list(views.text(artifact, _others(there))),
        "values": artifact.plain(),
        "arrays": {name: statistics(array) for name, array in artifact.arrays().items()},
        "made": _provenance(entry.record) if entry.record else None,
    }


def _others(there: Snapshot) -> Callable[[type[Artifact]], Artifact | None]:
    """Gives the results of other tasks, None where there are none."""

    def other(cls: type[Artifact]) -> Artifact | None:
        try:
            return there.artifact(cls)
        except KinetreeError:
            return None

    return other


def statistics(array: NDArray[Any]) -> dict[str, Any]:
    """Shape, dtype, and least, mean and greatest of the finite values."""
    measured: dict[str, Any] = {"shape": list(array.shape), "dtype": str(array.dtype)}
    finite = array[np.isfinite(array)] if array.dtype.kind == "f" else array
    if finite.size:
        measured |= {"min": finite.min().item(), "mean": float(finite.mean()), "max": finite.max().item()}
    if finite.size < array.size:
        measured["not finite"] = int(array.size - finite.size)
    return measured


def _schema(cls: type[Artifact]) -> dict[str, Any]:
    arrays, texts = cls.array_fields(), sentences(cls)
    fields = {}
    for name, field in cls.model_fields.items():
        spec = arrays.get(name)
        fields[name] = {"type": _type(spec) if spec else _type_name(field.annotation), "what": texts.get(name, "")}
    return {"name": cls.__name__, "version": cls.version, "fields": fields}


def _type(spec: Array) -> str:
    """An array's dtype, dimensions and unit, e.g. float64 (vertex, xyz=3) in length; a single number has no dimensions."""
    return f"{spec.dtype} {spec.layout + ' ' if spec.dims else ''}in {spec.unit}"


def _provenance(record: Record) -> dict[str, Any]:
    inputs = {i["argument"]: i["nodes"] if len(i["nodes"]) <= 3 else f"{len(i['nodes'])} nodes" for i in record.inputs}
    return {
        "created": record.created,
        "host": record.host,
        "seconds": round(record.seconds, 4),
        "peak_bytes_of_the_process": record.peak_bytes,
        "bytes": record.bytes,
        "params": record.params,
        "inputs": inputs,
        "key": record.key,
        "code": sorted(module for module in record.code if module),
        "versions": record.versions,
    }


def _type_name(annotation: Any) -> str:
    return annotation.__name__ if isinstance(annotation, type) else str(annotation).replace("typing.", "")
