"""Nodes at which a graph begins: what origins found, and what another graph made."""

from collections.abc import Collection, Iterator, Mapping

from kinetree.pipeline.graph import AnyTask
from kinetree.pipeline.identity.key import artifact_digest
from kinetree.pipeline.node import Node, label
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.layout import OriginArtifacts
from kinetree.schemas.array import Index

Links = Mapping[str, Mapping[Index, str]]
"""Digests of artifacts that another graph made, by task name and index."""


def accepted(task: AnyTask, links: Links, origin_artifacts: OriginArtifacts, known: Collection[Node]) -> Iterator[Entry]:
    """The nodes of an origin that are not known yet, all of them fresh."""
    for index, digest in links.get(task.name, {}).items():
        if (node := Node(task.name, index)) not in known:
            yield Entry(node, task, label(node, task.over), state="fresh", inputs=(), artifact=digest)
    for index, artifact in origin_artifacts.get(task.name, {}).items():
        if (node := Node(task.name, index)) not in known:
            digest = artifact_digest(artifact)
            yield Entry(node, task, label(node, task.over), state="fresh", inputs=(), artifact=digest)
