"""Which nodes travel together as one piece of work: those of one member, and a stretch of a chain."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.node import Node, project
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.task import Space

STRETCH = 16
"""Nodes of a chain that travel together at most: their arrays stay in one process, and none waits to be sent. Each result is
stored as soon as it is there, and heard of with the last one."""


def together(
    first: Entry,
    graph: Graph,
    entries: Mapping[Node, Entry],
    dependents: Callable[[Node], Sequence[Node]],
    unlisted: Collection[Node],
) -> list[Entry]:
    """A ready node and the nodes that need nothing else: the next ones of its own chain, or else all of its own member.

    What is made of a frame once goes with what is made of it last in the last pass: it is of the same frame.

    A stretch of a chain takes nothing along, since the rest of the chain waits for it, and a chain that branches ends there, so
    that its branches go on side by side. What little waits for does not travel with what much waits for. A node whose task has
    a limit of time travels alone, since time is taken of the whole piece, and so does one that is never tried again: who killed
    a worker is then certain at once.

    dependents : the nodes that read a node or are laid out by it
    unlisted   : nodes of which it is not known yet what they read
    returns    : these nodes, each after those of them that it reads
    """
    parcel, inside = [first], {first.node}
    if not first.node.at or is_alone(first.task):
        return parcel

    def waiting(member: Entry) -> Iterator[Entry]:
        for node in dependents(member.node):
            other = entries[node]
            if other.state == "waits" and node not in inside and node not in unlisted and other.waits <= inside:
                yield other

    def goes_along(other: Entry) -> bool:
        is_here = is_of_member(other.node, other.task.over, first.node, first.task.over)
        return is_here and not is_alone(other.task) and (other.task.name not in graph.aside or first.task.name in graph.aside)

    def add(other: Entry) -> None:
        inside.add(other.node)
        parcel.append(other)

    last = first
    for _ in range(STRETCH - 1 if first.task.along is not None else 0):
        following = [other for other in waiting(last) if other.task is first.task]
        if len(following) != 1:
            break
        (last,) = following
        add(last)
    if first.task.is_chain:
        return parcel
    for member in parcel:
        for other in waiting(member):
            if goes_along(other):
                add(other)
    rank = {task.name: n for n, task in enumerate(graph.tasks)}
    parcel.sort(key=lambda e: rank[e.node.task])
    return parcel


def is_of_member(node: Node, over: Space, first: Node, first_over: Space) -> bool:
    """Whether a node is of the member that another one is of: at its index, or at what its own dimensions have of that."""
    is_within = set(over) <= set(first_over) and over[-1:] == first_over[-1:]
    return is_within and node.at == project(first.at, first_over, over)


def is_alone(task: AnyTask) -> bool:
    """Whether nodes of a task travel alone: where the fate of the piece must be that of the node."""
    return task.timeout is not None or not task.retries
