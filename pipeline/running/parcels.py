"""Parcels as they travel: what a worker is told of each node, and no more; what whoever launches one is told."""

from dataclasses import dataclass

from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.planning.together import is_alone
from kinetree.pipeline.running.execute import Input, Ref, Step
from kinetree.pipeline.running.memory import Needs


@dataclass(frozen=True)
class Demand:
    """What a parcel asks of whoever computes it."""

    memory: int
    """Bytes; 0 where nobody knows."""
    seconds: float | None
    """How long it may take; None where there is no limit."""
    tells: bool = False
    """Whether the run hears when a worker begins it."""

    @staticmethod
    def of(parcel: list[Entry], needs: Needs) -> "Demand":
        """Of a parcel; one that has a limit of time, or is never tried again, is a single node."""
        task = parcel[0].task
        needed = needs.bytes(entry.task for entry in parcel)
        return Demand(needed, task.timeout, tells=is_alone(task))


def steps_of(schedule: Schedule, parcel: list[Entry]) -> tuple[Step, ...]:
    """What is to be computed at each node of a parcel, in order."""
    place, known = {entry.node: number for number, entry in enumerate(parcel)}, schedule.freshness
    return tuple(
        Step(
            label=entry.label,
            task=f"{entry.task.module}:{entry.task.name}",
            index=dict(zip(entry.task.over, entry.node.at, strict=True)),
            code=known.code[entry.node.task],
            params=known.params[entry.node.task],
            inputs=tuple(
                Input(a.name, a.form, tuple(_ref(schedule, place, n) for n in nodes), known.numbers(entry, a, nodes))
                for a, nodes in entry.inputs or ()
            ),
            key=entry.key if entry is parcel[0] else None,
            force=entry.node.task in known.force or any(r.kind == "artifact" for r in entry.reasons),
            distrusted=known.distrusted,
        )
        for entry in parcel
    )


def _ref(schedule: Schedule, place: dict[Node, int], node: Node) -> Ref:
    entry = schedule.entries[node]
    if node in place:
        return Ref(entry.label, step=place[node])
    if entry.task.is_origin and not entry.task.is_linked:
        return Ref(entry.label, carried=schedule.origin_artifacts[node.task][node.at])
    return Ref(entry.label, artifact=entry.artifact)
