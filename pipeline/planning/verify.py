"""Reads everything in a store and says what is damaged; removes that, so that a run makes it again."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from kinetree.errors import DamagedArtifactError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.storage.store import Store, artifact_path
from kinetree.schemas.array import Artifact


@dataclass(frozen=True)
class Verified:
    """What was read, and what of it is damaged."""

    artifacts: int
    """How many were read."""
    damaged: Mapping[str, str]
    """By digest: what is wrong with an artifact that lies there or that a record names."""
    nodes: Mapping[str, tuple[str, ...]]
    """By digest: the nodes of the runs on record that made it."""
    records: tuple[str, ...]
    """Records and packs of records that cannot be read."""
    runs: tuple[str, ...]
    """Runs whose record cannot be read."""

    @property
    def is_sound(self) -> bool:
        """Whether nothing is damaged."""
        return not (self.damaged or self.records or self.runs)

    def lines(self) -> list[str]:
        """One line for everything that is damaged."""
        named = {d: ", ".join(self.nodes.get(d, ())[:3]) or "no run on record" for d in self.damaged}
        artifacts = [f"{artifact_path(d)} ({named[d]}): {what}" for d, what in self.damaged.items()]
        return [*artifacts, *(f"{path}: cannot be read" for path in (*self.records, *self.runs))]

    def json(self) -> dict[str, Any]:
        """As JSON values."""
        nodes = {digest: list(self.nodes.get(digest, ())) for digest in self.damaged}
        report = {"artifacts": self.artifacts, "damaged": dict(self.damaged), "nodes": nodes}
        return {**report, "records": list(self.records), "runs": list(self.runs)}


def verify(store: Store, graphs: Iterable[Graph]) -> Verified:
    """Reads every artifact, record and run of a store.

    graphs : whose artifact classes are known; of any other an artifact's digests are checked and not its schema
    """
    classes = {task.returns.__name__: task.returns for graph in graphs for task in graph.tasks}
    there = list(store.artifacts())
    damaged = {digest: what for digest in there if (what := _damage(store, digest, classes))}
    damaged = {**missing(store), **damaged}
    nodes: dict[str, tuple[str, ...]] = {}
    for run in store.runs():
        for label, node in run["nodes"].items():
            if node.get("artifact") in damaged and label not in nodes.get(node["artifact"], ()):
                nodes[node["artifact"]] = (*nodes.get(node["artifact"], ()), label)
    sound = {run["name"] for run in store.runs()}
    runs = tuple(f"runs/{name}.json" for name in store.run_names() if name not in sound)
    return Verified(len(there), damaged, nodes, tuple(store.records.damaged()), runs)


def missing(store: Store) -> dict[str, str]:
    """By digest: what is wrong with an artifact that a record names and that does not lie there in its size."""
    sizes = {r.artifact: store.place.size(artifact_path(r.artifact)) for r in store.records.all() if not store.holds(r)}
    return {digest: "it is missing" if size is None else "its size is not that on record" for digest, size in sizes.items()}


def discard_damage(store: Store, verified: Verified) -> None:
    """Removes what is damaged: records and runs whole, artifacts with the records that name them.

    Their nodes are no longer up to date: a run computes again those that it needs, and the others when they are asked for.
    """
    store.records.remove([record.key for record in store.records.all() if record.artifact in verified.damaged])
    for digest in verified.damaged:
        store.discard(digest)
    store.records.discard_damaged()
    for path in verified.runs:
        store.place.remove(path)


def _damage(store: Store, digest: str, classes: Mapping[str, type[Artifact]]) -> str:
    try:
        store.check(digest, classes)
    except DamagedArtifactError as error:
        return error.what
    return ""
