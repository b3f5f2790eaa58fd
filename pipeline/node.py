"""A node: one task at one index, and how it is written: mesh[frame=3], cones[interval=1], skeleton."""

import re
from typing import NamedTuple

from kinetree.errors import UnknownNodeError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import Space
from kinetree.schemas.array import Index


class Node(NamedTuple):
    """One task at one index."""

    task: str
    at: Index = ()


def label(node: Node, over: Space) -> str:
    """The node as text, e.g. mesh[frame=3]."""
    if not node.at:
        return node.task
    return f"{node.task}[{','.join(f'{d}={i}' for d, i in zip(over, node.at, strict=True))}]"


def parse(text: str, graph: Graph) -> Node:
    """The node that a text names: mesh[frame=3], or shorter mesh[3]; raises UnknownNodeError."""
    written = re.fullmatch(r"\s*(\w+)\s*(?:\[(.*)\])?\s*", text) if isinstance(text, str) else None
    if written is None:
        raise UnknownNodeError(f"{text!r}: not a node; write a task, or a task with its index: {_example(graph)}")
    task = graph.task(written.group(1))
    parts = [p.strip() for p in (written.group(2) or "").split(",") if p.strip()]
    expected = f"{task.name}[{','.join(f'{d}=…' for d in task.over)}]" if task.over else task.name
    if len(parts) != len(task.over):
        raise UnknownNodeError(f"{text!r}: a node of {task.name} is written {expected}")
    index = []
    for part, dim in zip(parts, task.over, strict=True):
        name, equals, number = part.rpartition("=")
        if (equals and name.strip() != dim) or not re.fullmatch(r"\s*[0-9]{1,18}\s*", number):
            raise UnknownNodeError(f"{text!r}: a node of {task.name} is written {expected}")
        index.append(int(number))
    return Node(task.name, tuple(index))


def project(index: Index, space: Space, onto: Space) -> Index:
    """The part of an index that belongs to the dimensions of `onto`, all of which `space` has."""
    return index if onto == space else tuple(index[space.index(dim)] for dim in onto)


def _example(graph: Graph) -> str:
    """A node as a message can give it for an example: of the first task that has an index."""
    task = next((task for task in graph.tasks if task.over), graph.tasks[0])
    return label(Node(task.name, (3,) * len(task.over)), task.over)
