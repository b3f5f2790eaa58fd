"""Why a node is stale: what differs between what it would compute now and what it computed last."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from kinetree.pipeline.storage.store import Record

Kind = Literal["never ran", "params", "code", "index", "input", "artifact", "made with", "forced"]


@dataclass(frozen=True)
class Reason:
    """One cause, and what exactly: the parameter old → new, the definition, the input."""

    kind: Kind
    what: str = ""

    def __str__(self) -> str:
        return f"{self.kind}: {self.what}" if self.what else self.kind


@dataclass(frozen=True)
class Work:
    """All that decides what a node computes, in words a person can compare."""

    params: Mapping[str, Any]
    code: Mapping[str, str]
    inputs: Sequence[Mapping[str, Any]]
    """Per argument: argument, form, nodes, artifacts."""
    index: Mapping[str, int] | None = None
    """Its index by dimension, where the task asks for it."""


def never_ran() -> Reason:
    """No earlier run on record computed this node."""
    return Reason("never ran")


def differences(now: Work, then: Record) -> tuple[Reason, ...]:
    """What differs between work to do and work that was done: parameters, then code, then the index, then inputs."""
    return (
        *_params(now.params, then.params),
        *_code(now.code, then.code),
        *_index(now.index, then.index if then.asks_index else None),
        *_inputs(now.inputs, then.inputs),
    )


def _params(now: Mapping[str, Any], then: Mapping[str, Any]) -> tuple[Reason, ...]:
    names = sorted(n for n in {*now, *then} if now.get(n, _ABSENT) != then.get(n, _ABSENT))
    return tuple(Reason("params", f"{n} {then.get(n, _ABSENT)!r} → {now.get(n, _ABSENT)!r}") for n in names)


def _code(now: Mapping[str, str], then: Mapping[str, str]) -> tuple[Reason, ...]:
    if any(":" not in parts for parts in then.values()):
        return (Reason("code", "the earlier run identified it by whole modules"),)
    reasons: list[Reason] = []
    for module in sorted({*now, *then}):
        a, b = _definitions(then.get(module, "")), _definitions(now.get(module, ""))
        names = sorted(name for name in {*a, *b} if a.get(name) != b.get(name))
        if names and not module:
            reasons.append(Reason("code", "the order of imports"))
        elif names:
            more = f" and {len(names) - 3} more" if len(names) > 3 else ""
            reasons.append(Reason("code", f"{module}:{', '.join(names[:3])}{more}"))
    return tuple(reasons)


def _definitions(parts: str) -> dict[str, str]:
    """The short digest of every definition, from the words of a record."""
    return dict(part.rsplit(":", 1) for part in parts.split())


def _index(now: Mapping[str, int] | None, then: Mapping[str, int] | None) -> tuple[Reason, ...]:
    before, after = (_ABSENT if index is None else ",".join(f"{d}={i}" for d, i in index.items()) for index in (then, now))
    return (Reason("index", f"{before} → {after}"),) if now != then else ()


def _inputs(now: Sequence[Mapping[str, Any]], then: Sequence[Mapping[str, Any]]) -> tuple[Reason, ...]:
    before, after = _by_node(then), _by_node(now)
    reasons: list[Reason] = []
    for verb, nodes in (
        ("changed", [n for n in after if n in before and before[n] != after[n]]),
        ("added", [n for n in after if n not in before]),
        ("removed", [n for n in before if n not in after]),
    ):
        if nodes:
            more = f" and {len(nodes) - 3} more" if len(nodes) > 3 else ""
            reasons.append(Reason("input", f"{', '.join(nodes[:3])}{more} {verb}"))
    if not reasons and [(i["argument"], i["form"]) for i in now] != [(i["argument"], i["form"]) for i in then]:
        reasons.append(Reason("input", "the task takes other arguments"))
    return tuple(reasons)


def _by_node(inputs: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    return {node: artifact for i in inputs for node, artifact in zip(i["nodes"], i["artifacts"], strict=True)}


class _Absent:
    def __repr__(self) -> str:
        return "(none)"


_ABSENT = _Absent()
Recalled = Record | Literal["nothing", "lost"]
"""What a node computed in the last run: nothing, something whose record is gone or unreadable, or what its record says."""
Recall = Callable[[str], Recalled]
"""Looks that up by the node's label."""
