"""The pipeline as a program sees it: plan it, run it, ask what is there, why it is stale and from what it was made.

pipeline = Pipeline.of("walk.yaml")
pipeline.plan()                           what a run would do; computes nothing
pipeline.run()                            does it
pipeline.artifact("task", frame=3)        typed, arrays read when asked for
"""

import html
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import networkx as nx

from kinetree.errors import NodesFailedError, UnknownNodeError
from kinetree.pipeline import config as configuration
from kinetree.pipeline import views
from kinetree.pipeline.application import Application, current
from kinetree.pipeline.config import Config
from kinetree.pipeline.diff import difference
from kinetree.pipeline.events import Account, Listener, Watch
from kinetree.pipeline.files import Files
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.heartbeat import beating
from kinetree.pipeline.history import History, closing, new_name, opening, summary
from kinetree.pipeline.look import Difference, RunList, RunSummary, html_table
from kinetree.pipeline.node import Node, label, parse
from kinetree.pipeline.origins import found
from kinetree.pipeline.output import as_yaml, pages, write_config, write_pages, write_results, write_run_json
from kinetree.pipeline.plan import Plan, Planned
from kinetree.pipeline.schedule import Schedule
from kinetree.pipeline.store import Store
from kinetree.schemas.array import Artifact


@dataclass(frozen=True)
class Pipeline:
    """One graph over one sequence with one configuration and one store; making one computes nothing."""

    config: Config
    tasks: Graph
    store: Store = field(repr=False)

    @staticmethod
    def of(
        config: str | Path | Mapping[str, Any] | Config | None = None,
        *,
        sets: Iterable[str] = (),
        application: Application | None = None,
        methods: Mapping[str, Graph] | None = None,
    ) -> "Pipeline":
        """The pipeline of a YAML file, a preset's name, an earlier run's output folder, a mapping or a checked Config.

        sets        : overrides as task.name=value
        application : the product; None takes the one whose command line is running or else the one that is installed
        methods     : graphs by name in place of the application's, the default first
        raises      : ConfigError, StoreError
        """
        product = application or current()
        if methods is not None:
            graphs = methods
            product = replace(product, methods=lambda: graphs)
        checked = config if isinstance(config, Config) else configuration.load(config, product, sets)
        return Pipeline(checked, product.methods()[checked.method], Store.at(checked.store))

    def __repr__(self) -> str:
        """What it runs on and where it leaves things."""
        names = ", ".join(task.name for task in self.tasks.tasks)
        return f"Pipeline({self.config.method}: {names}; output {self.config.output}, store {self.store.url})"

    def _repr_html_(self) -> str:
        rows = [(task.name, "/".join(task.over), task.summary, task.paper) for task in self.tasks.tasks]
        where = html.escape(f"output {self.config.output}, store {self.store.url}")
        return f"<p>{where}</p>{html_table(('task', 'per', 'what', 'paper'), rows)}"

    def plan(self, *, until: Iterable[str] = (), force: Iterable[str] = ()) -> Plan:
        """Every node with its state and the reason for it; looks at the input, computes nothing."""
        return Plan.of(self.schedule(until=tuple(until) or self.tasks.unasked, force=force))

    def schedule(self, *, until: Iterable[str] = (), force: Iterable[str] = ()) -> Schedule:
        """The schedule of the named tasks or of all there are, laid out as far as it is known."""
        return self._schedule(Files.of(self.store), until, force)[0]

    def _schedule(self, files: Files, until: Iterable[str], force: Iterable[str]) -> tuple[Schedule, list[str]]:
        wanted = tuple(until)
        graph = self.tasks.until(wanted) if wanted else self.tasks
        forced = [self.tasks.task(name).name for name in force]
        history = History.of(self.store, self.config)
        given, notes = found(graph, self.config, files, history)
        return Schedule(graph, self.config.params, self.store, given, force=forced, recall=history.recall), notes

    def run(
        self,
        client: Any = None,
        *,
        until: Iterable[str] = (),
        force: Iterable[str] = (),
        listeners: Iterable[Listener] = (),
    ) -> RunSummary:
        """Runs what is out of date; returns the content of run.json and the run's name, in which failed nodes are listed.

        client : a `distributed.Client` to run on; None runs where the configuration says
        raises : InputError where the user's input is wrong; KeyboardInterrupt after the store was left whole
        """
        started = time.perf_counter()
        files = Files.of(self.store)
        schedule, notes = self._schedule(files, tuple(until) or self.tasks.unasked, force)
        self.store.create()
        files.save()
        write_config(self.config)
        opened = opening(new_name(), self.config, schedule)
        self.store.write_run(opened["name"], opened)
        account = Account()
        watch = Watch((account, *listeners))
        watch.begin(opened["name"], schedule.entries.values())
        status, left = "interrupted", list[str]()
        try:
            with beating(self.store, opened["name"]):
                self._go(schedule, watch, client)
            left += write_results(self.config.output, schedule) + pages(schedule)
            status = "failed" if account.failures else "done"
        except Exception:
            status = "stopped"
            raise
        finally:
            seconds = time.perf_counter() - started
            watch.end(status, seconds)
            summed = {**summary(account, status, seconds), "files": left, **({"notes": notes} if notes else {})}
            self._close(opened, schedule, account, summed)
        write_pages(self.config.output, schedule, {"run": opened["name"], **summed, **self._described()})
        return RunSummary({"run": opened["name"], **summed})

    def _described(self) -> dict[str, Any]:
        """The graph and the configuration, for a page about a run."""
        graph = {t.name: {"over": "/".join(t.over), "reads": [r.name for r in self.tasks.reads(t)]} for t in self.tasks.tasks}
        return {"graph": graph, "config": as_yaml(self.config.saved())}

    def computed(self, name: str) -> Schedule:
        """Computes one task from what is there and nothing else; returns the schedule that has its artifacts.

        raises : UnknownNodeError where something it reads is not there; NodesFailedError where it fails itself
        """
        schedule = self.schedule(until=[name])
        reads = {task.name for task in self.tasks.reads(self.tasks.task(name))}
        todo = [node for node in Plan.of(schedule).nodes if node.task != name and node.state != "fresh"]
        lacking = [node.node for node in todo if node.task in reads]
        if lacking:
            more = f" and {len(lacking) - 1} more" if len(lacking) > 1 else ""
            first = next((node for node in todo if node.state == "stale"), todo[0])
            where = f"{name} is made from {lacking[0]}{more}, which has no up-to-date result"
            raise UnknownNodeError(f"{where}: {first}; kinetree run computes what is missing")
        account = Account()
        self._go(schedule, Watch((account,)), None)
        if account.failures:
            failure = account.failures[0]
            raise NodesFailedError(f"{failure['node']}: {failure['error']}: {failure['message']}")
        return schedule

    def graph(self, *, expanded: bool = False) -> "nx.DiGraph[str]":
        """The graph of tasks, or expanded of nodes; each node's `data` is a TaskPlan or Planned, edges name arguments."""
        schedule = self.schedule()
        if expanded:
            return _expanded(schedule)
        drawn = self.tasks.networkx()
        for row in Plan.of(schedule).tasks:
            drawn.nodes[row.task]["data"] = row
        return drawn

    def why(self, node: str) -> Planned:
        """The state of one node and the reason for it."""
        schedule = self.schedule()
        return Plan.of(schedule)[schedule.entries[node_named(schedule, node)].label]

    def lineage(self, node: str) -> "nx.DiGraph[str]":
        """The part of the expanded graph from which this node is made and which is made from it."""
        schedule = self.schedule()
        nodes = _expanded(schedule)
        name = schedule.entries[node_named(schedule, node)].label
        related = nx.ancestors(nodes, name) | nx.descendants(nodes, name) | {name}
        return nx.DiGraph(nodes.subgraph(related))

    def artifact(self, name: str, *, within: Schedule | None = None, **index: int) -> Artifact:
        """The artifact of a task at an index, with arrays that are read when asked for.

        within : a schedule to ask, for who asks often; None lays out a new one
        raises : UnknownNodeError where there is no such node or it has not been computed
        """
        schedule = within or self.schedule(until=[name])
        over = self.tasks.task(name).over
        if set(index) != set(over):
            given = ", ".join(index) or "no index"
            raise UnknownNodeError(f"{name} runs over {'/'.join(over) or 'nothing'}; got {given}")
        node = node_named(schedule, label(Node(name, tuple(index[d] for d in over)), over))
        if schedule.entries[node].artifact is None:
            planned = Plan.of(schedule)[schedule.entries[node].label]
            raise UnknownNodeError(f"{planned}; it has no result until kinetree run computes it")
        return schedule.value(node)

    def remarks(self) -> list[tuple[str, str]]:
        """What the results that stand for the whole sequence have to say, as (node, sentence)."""
        schedule = self.schedule()
        whole = [e for e in schedule.entries.values() if not e.task.over and e.artifact is not None and not e.task.is_origin]
        return [(e.label, text) for e in whole for text in views.remarks(schedule.value(e.node))]

    def runs(self) -> RunList:
        """Every run on record in this store, oldest first."""
        return RunList(History.of(self.store, self.config).runs())

    def diff(self, run_a: str, run_b: str) -> Difference:
        """What differs between two runs, and from where: nodes whose inputs agree but whose artifacts do not."""
        return Difference(difference(self.store, self.store.run(run_a), self.store.run(run_b)))

    def _go(self, schedule: Schedule, watch: Watch, client: Any) -> None:
        """Starts workers only where there is something to run."""
        if all(entry.state == "fresh" for entry in schedule.entries.values()) and not any(schedule.blocked.values()):
            return
        from kinetree.pipeline.run import launcher, run

        with launcher(self.config.compute, client) as launch:
            run(schedule, launch, watch)

    def _close(self, opened: dict[str, Any], schedule: Schedule, account: Account, summed: dict[str, Any]) -> None:
        before = History.of(self.store, self.config).last_nodes()
        write_run_json(self.config, summed)
        self.store.write_run(opened["name"], closing(opened, schedule, before, account, summed))


def node_named(schedule: Schedule, text: str) -> Node:
    """The node of a schedule that a text names; raises UnknownNodeError, with what there is."""
    node = parse(text, schedule.graph)
    if node not in schedule.entries:
        unknown = schedule.blocked.get(node.task, ())
        known = sum(1 for n in schedule.entries if n.task == node.task)
        later = f"; there may be more once {schedule.entries[unknown[0]].label} is computed" if unknown else ""
        raise UnknownNodeError(f"{text}: no such node; {node.task} has {known} nodes{later}")
    return node


def _expanded(schedule: Schedule) -> "nx.DiGraph[str]":
    nodes: nx.DiGraph[str] = nx.DiGraph()
    for row in Plan.of(schedule).nodes:
        nodes.add_node(row.node, task=row.task, state=row.state, data=row)
    for entry in schedule.entries.values():
        for argument, reads in entry.inputs or ():
            for node in reads:
                told = {"argument": argument.name, "form": argument.form, "previous": argument.previous}
                nodes.add_edge(schedule.entries[node].label, entry.label, **told)
    return nodes
