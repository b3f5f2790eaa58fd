"""Artifacts that turned out to be damaged: looked at once more, and removed before they are made again."""

from collections.abc import Mapping, Sequence

from kinetree.errors import DamagedArtifactError, StoreError
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.storage.store import Store

MENDS = 3
"""How often a node is computed again because its artifact is damaged, before the disk is to blame."""


def is_whole(store: Store, maker: Entry, artifact: str) -> bool:
    """Whether every array of what a node made can be read and is what it was."""
    try:
        store.read(maker.task.returns, artifact).arrays()
    except DamagedArtifactError:
        return False
    return True


def makers_of(entries: Mapping[Node, Entry], reader: Entry, artifact: str, what: str) -> list[Node]:
    """The nodes that make an artifact which a node could not read; none where another graph makes it.

    raises : StoreError where nobody makes it
    """
    made = {node: entry.task for node, entry in entries.items() if entry.artifact == artifact}
    makers = [node for node, task in made.items() if not task.is_origin]
    if not makers and not any(task.is_linked for task in made.values()):
        raise StoreError(f"{reader.label}: artifact {artifact[:12]} {what} and nothing here makes it")
    return makers


def discard_damaged(store: Store, maker: Entry, artifact: str) -> None:
    """Removes what was found damaged, unless another node that makes the same has mended it already."""
    if not is_whole(store, maker, artifact):
        store.discard(artifact)


def is_mended(store: Store, reader: Entry, makers: Sequence[Entry], artifact: str) -> bool:
    """Whether a reader had begun before its input was made again, and may read it now; believed once of each reader."""
    return not reader.is_late and any(maker.redone for maker in makers) and is_whole(store, makers[0], artifact)
