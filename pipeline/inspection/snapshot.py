"""What there is at one moment: one look at input and store that answers every question about the graph.

there = pipeline.inspect()
there.plan                                what a run would do
there.why("task[frame=3]")                the state of one node and the reason
there.artifact(Class, frame=3)            typed, arrays read when asked for
there.timings                             seconds, memory and bytes by task
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from kinetree.errors import UnknownNodeError
from kinetree.pipeline import views
from kinetree.pipeline.inspection.history import History
from kinetree.pipeline.inspection.plan import Plan, Planned
from kinetree.pipeline.inspection.timings import Estimate, Timings, estimated
from kinetree.pipeline.inspection.typed_by_name import typed_by_name
from kinetree.pipeline.node import Node, label, parse
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.schemas.array import Artifact

if TYPE_CHECKING:  # networkx is imported when a graph is asked for
    from kinetree.pipeline.inspection.drawn_graph import DrawnGraph


@dataclass(frozen=True, repr=False)
class Snapshot:
    """The nodes of a pipeline as they are now; what is computed or changed later is not in it."""

    schedule: Schedule
    history: History
    notes: tuple[str, ...] = ()
    """What is to be known of the input, e.g. that it was not found and the last run's is taken."""
    named: tuple[str, ...] = ()
    """The tasks that were asked for by name; where there are none a run leaves out those on request."""
    unkept: str = ""
    """Why what was computed for it is in the memory of this process alone; empty where it is not."""

    @cached_property
    def plan(self) -> Plan:
        """Every node with its state and the reason for it."""
        return Plan.of(self.schedule)

    @cached_property
    def timings(self) -> Timings:
        """By task, what its up-to-date nodes took when they were computed."""
        return Timings.of(self.schedule.entries.values())

    def estimate(self) -> Estimate:
        """How long a run would take, from what nodes took before; by task, and how many nodes have no such figure.

        Tasks on request count where they, or tasks that read them, were asked for by name.
        """
        graph = self.schedule.graph
        wanted = graph.until(self.named or graph.unasked).by_name
        return estimated(self.schedule, self.history.records(), wanted)

    @cached_property
    def graph(self) -> "DrawnGraph":
        """The graph of tasks; each one's `data` is its TaskPlan, edges have argument, form and previous."""
        from kinetree.pipeline.inspection.drawn_graph import DrawnGraph

        drawn = DrawnGraph(self.schedule.graph.networkx())
        for row in self.plan.tasks:
            drawn.nodes[row.task]["data"] = row
        return drawn

    @cached_property
    def nodes(self) -> "DrawnGraph":
        """The graph of nodes; each one's `data` is its Planned, edges have argument, form and previous."""
        from kinetree.pipeline.inspection.drawn_graph import DrawnGraph

        drawn = DrawnGraph()
        for row in self.plan.nodes:
            drawn.add_node(row.node, task=row.task, state=row.state, data=row)
        for entry in self.schedule.entries.values():
            for argument, reads in entry.inputs or ():
                for node in reads:
                    edge = {"argument": argument.name, "form": argument.form, "previous": argument.previous}
                    drawn.add_edge(self.schedule.entries[node].label, entry.label, **edge)
        return drawn

    def entry(self, node: str) -> Entry:
        """The schedule's entry of the node that a text names; raises UnknownNodeError, with what there is."""
        named = parse(node, self.schedule.graph)
        if named not in self.schedule.entries:
            unknown = self.schedule.blocked.get(named.task, ())
            known = sum(1 for n in self.schedule.entries if n.task == named.task)
            later = f"; there may be more once {self.schedule.entries[unknown[0]].label} is computed" if unknown else ""
            raise UnknownNodeError(f"{node}: no such node; {named.task} has {known} nodes{later}")
        return self.schedule.entries[named]

    def why(self, node: str) -> Planned:
        """The state of one node and the reason for it; raises UnknownNodeError."""
        return self.plan[self.entry(node).label]

    def lineage(self, node: str) -> "DrawnGraph":
        """The part of the graph of nodes from which this node is made and which is made from it."""
        import networkx as nx

        from kinetree.pipeline.inspection.drawn_graph import DrawnGraph

        name = self.entry(node).label
        related = nx.ancestors(self.nodes, name) | nx.descendants(self.nodes, name) | {name}
        return DrawnGraph(self.nodes.subgraph(related))

    @typed_by_name
    def artifact(self, what: type[Artifact] | str, **index: int) -> Artifact:
        """The artifact of a class or of a task's name at an index, with arrays that are read when asked for.

        what   : the artifact's class or the name of the task that writes it; a type checker follows both
        index  : one number for each dimension that the task runs over
        raises : UnknownNodeError where there is no such node or it has not been computed
        """
        task = self.schedule.graph.writer(what)
        if set(index) != set(task.over):
            dims = ", ".join(index) or "no index"
            raise UnknownNodeError(f"{task.name} runs over {'/'.join(task.over) or 'nothing'}; got {dims}")
        entry = self.entry(label(Node(task.name, tuple(index[d] for d in task.over)), task.over))
        if entry.artifact is None:
            raise UnknownNodeError(f"{self.plan[entry.label]}; it has no result until it is computed by a run")
        return self.schedule.value(entry.node)

    def remarks(self) -> list[tuple[str, str]]:
        """What the results that stand for the whole sequence have to say, as (node, sentence)."""
        return [(e.label, text) for e in self._whole() for text in views.remarks(self.schedule.value(e.node))]

    def _whole(self) -> Iterator[Entry]:
        for entry in self.schedule.entries.values():
            if not entry.task.over and entry.artifact is not None and not entry.task.is_origin:
                yield entry

    def __repr__(self) -> str:
        """The plan, one line a task."""
        return repr(self.plan)

    def _repr_html_(self) -> str:
        return self.plan._repr_html_()
