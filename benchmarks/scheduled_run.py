"""A run of known nodes on so many workers: parcels and their order as the loom makes them, one process that sends them all."""

import graphlib
import heapq
import itertools
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.together import STRETCH, is_of_member
from kinetree.pipeline.task import Space

AT_WORKER = 0.003
"""Seconds that a node takes at its worker beside those on record."""
OF_NODE, OF_PARCEL = 0.0006, 0.00185
"""Seconds that a node, and the parcel that it travels in, take in the process that sends all, with dask's scheduler.

Measured in runs of 300 frames of one and of six nodes that compute nothing, two worker processes, on a busy machine: 0.0021 a
parcel. Since results come as events on the scheduler's stream a parcel takes 0.88 of that, the median of six pairs of runs. It
took 0.0035 where other programs interrupt that process.
"""


@dataclass(frozen=True)
class Job:
    """One node: over which space its task runs, how urgent it is, whether it is aside (`Graph.aside`) or of a chain, what
    it takes and what it waits for.
    """

    node: Node
    space: Space
    urgency: int
    is_aside: bool
    is_chain: bool
    seconds: float
    before: frozenset[Node]


Jobs = dict[Node, Job]


@dataclass(frozen=True)
class Parcel:
    """Nodes that travel together: from when to when, and after which other it was sent."""

    nodes: tuple[Node, ...]
    begin: float
    end: float
    sent_after: "Parcel | None"


def makespan(jobs: Jobs, workers: int) -> float:
    """Seconds until the last node is done."""
    return max(parcel.end for parcel in scheduled(jobs, workers))


def scheduled(jobs: Jobs, workers: int) -> list[Parcel]:
    """All parcels in the order of their ends, if a free worker takes the most urgent node that is ready, with its parcel."""
    waits = {node: set(job.before) for node, job in jobs.items()}
    after: defaultdict[Node, list[Node]] = defaultdict(list)
    for node, job in jobs.items():
        for read in job.before:
            after[read].append(node)
    ready = [(-job.urgency, node.at, node) for node, job in jobs.items() if not job.before]
    heapq.heapify(ready)
    sent: set[Node] = set()
    under_way: list[tuple[float, int, float, list[Node], Parcel | None]] = []
    now = 0.0
    numbers = itertools.count()
    done: list[Parcel] = []
    while ready or under_way:
        while ready and len(under_way) < workers:
            parcel = _parcel(jobs, waits, after, heapq.heappop(ready)[2])
            sent.update(parcel)
            took = sum(jobs[node].seconds + AT_WORKER for node in parcel)
            heapq.heappush(under_way, (now + took, next(numbers), now, parcel, done[-1] if done else None))
        end, _, begin, parcel, sent_after = heapq.heappop(under_way)
        now = max(end, now) + OF_PARCEL + OF_NODE * len(parcel)
        done.append(Parcel(tuple(parcel), begin, now, sent_after))
        for node in parcel:
            for later in after[node]:
                waits[later].discard(node)
                if not waits[later] and later not in sent:
                    heapq.heappush(ready, (-jobs[later].urgency, later.at, later))
    return done


def longest_path(jobs: Jobs) -> list[Job]:
    """The nodes, each waiting for the one before, that take longest together: no number of workers is faster."""
    until: dict[Node, float] = {}
    last: dict[Node, Node | None] = {}
    for node in _in_order(jobs):
        last[node] = max(jobs[node].before, key=until.__getitem__, default=None)
        before = last[node]
        until[node] = jobs[node].seconds + (until[before] if before else 0.0)
    node: Node | None = max(until, key=until.__getitem__)
    path: list[Job] = []
    while node is not None:
        path.append(jobs[node])
        node = last[node]
    return path[::-1]


def _parcel(jobs: Jobs, waits: dict[Node, set[Node]], after: dict[Node, list[Node]], first: Node) -> list[Node]:
    """The nodes that travel together, by the rule of `together`."""
    parcel, last = [first], first
    for _ in range(STRETCH - 1):
        following = [n for n in after[last] if n.task == first.task and n not in parcel and waits[n] <= set(parcel)]
        if len(following) != 1:
            break
        (last,) = following
        parcel.append(last)
    for member in parcel if first.at and not jobs[first].is_chain else ():
        for node in after[member]:
            is_here = is_of_member(node, jobs[node].space, first, jobs[first].space)
            goes_along = jobs[first].is_aside or not jobs[node].is_aside
            if is_here and goes_along and node not in parcel and waits[node] <= set(parcel):
                parcel.append(node)
    return parcel


def _in_order(jobs: Jobs) -> Iterable[Node]:
    return graphlib.TopologicalSorter({node: job.before for node, job in jobs.items()}).static_order()
