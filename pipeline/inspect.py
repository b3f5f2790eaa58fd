"""The pipeline as a program sees it: plan it, run it, ask what is there, why it is stale and from what it was made.

pipeline = Pipeline.of("walk.yaml")
pipeline.plan()                           what a run would do; computes nothing
pipeline.run()                            does it
pipeline.inspect()                        what there is now, to be asked many things
pipeline.artifact(Class, frame=3)         typed, arrays read when asked for
"""

import html
import time
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinetree.errors import NodesFailedError, ReadOnlyStoreError, StoreFullError, UnknownNodeError
from kinetree.pipeline.application import Application, current, helped
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.identity.key import artifact_digest, digest
from kinetree.pipeline.identity.own_code import code_digest
from kinetree.pipeline.inspection.diff import difference
from kinetree.pipeline.inspection.history import History
from kinetree.pipeline.inspection.look import Difference, RunList, html_table
from kinetree.pipeline.inspection.origins import origin_artifacts
from kinetree.pipeline.inspection.plan import Plan, Planned
from kinetree.pipeline.inspection.run_summary import RunSummary
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.pipeline.inspection.typed_by_name import typed_by_name
from kinetree.pipeline.output.output import as_yaml
from kinetree.pipeline.output.session import Session, Status
from kinetree.pipeline.planning.layout import OriginArtifacts
from kinetree.pipeline.planning.made_with import MadeWith
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.running.events import Account, Listener, Watch
from kinetree.pipeline.running.interrupts import raise_swallowed
from kinetree.pipeline.running.memory import Needs
from kinetree.pipeline.running.worker_parent import WorkerParent, refuse_within_import
from kinetree.pipeline.running.workers import refuse_no_client
from kinetree.pipeline.settings import config as configuration
from kinetree.pipeline.settings.config import Compute, Config
from kinetree.pipeline.storage.files import Files, Settling
from kinetree.pipeline.storage.gc import advising
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.array import Artifact

if TYPE_CHECKING:  # networkx is imported when a graph is asked for
    from kinetree.pipeline.inspection.drawn_graph import DrawnGraph

Outside = tuple[OriginArtifacts, list[str]]
"""What origins find, and remarks on it."""


@dataclass(frozen=True)
class Pipeline:
    """One graph over one sequence with one configuration and one store; making one computes nothing."""

    config: Config
    tasks: Graph
    store: Store = field(repr=False)
    beside: str | None = field(default=None, repr=False, compare=False)
    """See `Application.beside`."""
    worker_setup: str | None = field(default=None, repr=False, compare=False)
    """See `Application.worker_setup`."""

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
        graph = replace(product.methods()[checked.method], renamed=product.renamed)
        return Pipeline(checked, graph, Store.at(checked.store), product.beside, product.worker_setup)

    def __repr__(self) -> str:
        """What it runs on and where it leaves things."""
        names = ", ".join(task.name for task in self.tasks.tasks)
        return f"Pipeline({self.config.method}: {names}; output {self.config.output}, store {self.store.url})"

    def _repr_html_(self) -> str:
        rows = [(task.name, "/".join(task.over), task.summary, task.paper) for task in self.tasks.tasks]
        where = html.escape(f"output {self.config.output}, store {self.store.url}")
        return f"<p>{where}</p>{html_table(('task', 'per', 'what', 'paper'), rows)}"

    def inspect(self, *, until: Iterable[str] = (), force: Iterable[str] = (), made_with: Iterable[str] = ()) -> Snapshot:
        """What there is now, to be asked many things: plan, why, lineage, artifacts, timings, graphs; computes nothing.

        until     : only these tasks and those they need; none means all
        force     : tasks that count as out of date
        made_with : requirements such as "scipy<1.17"; results computed with such a version count as out of date
        raises    : ConfigError, InputError, UnknownNodeError
        """
        return self._snapshot(Files.of(self.store), tuple(until), force, made_with)

    def plan(self, *, until: Iterable[str] = (), force: Iterable[str] = (), made_with: Iterable[str] = ()) -> Plan:
        """Every node with its state and the reason for it; looks at the input, computes nothing."""
        return self.inspect(until=tuple(until) or self.tasks.unasked, force=force, made_with=made_with).plan

    def schedule(self, *, until: Iterable[str] = (), force: Iterable[str] = ()) -> Schedule:
        """The schedule of the named tasks or of all there are, laid out as far as it is known."""
        return self.inspect(until=until, force=force).schedule

    def _snapshot(
        self, files: Files, wanted: tuple[str, ...], force: Iterable[str] = (), made_with: Iterable[str] = ()
    ) -> Snapshot:
        return self.look(files, History.of(self.store, self.config), wanted, force, made_with)

    def look_outside(self, files: Files, history: History) -> Outside:
        """What the origins of all tasks that run unasked find now, and remarks on it; raises InputError."""
        return origin_artifacts(self.tasks.until(self.tasks.unasked), self.config, files, history)

    def mark(self, outside: Outside) -> str:
        """A digest of all that decides what a run leaves: parameters, code, and what the origins found."""
        tasks = [self.tasks.task(name) for name in self.tasks.unasked]
        code = {task.name: code_digest(task.module, task.name) for task in tasks}
        params = {name: block.model_dump(mode="json") for name, block in self.config.params.items()}
        digests = {
            task: [[list(index), artifact_digest(artifact)] for index, artifact in members.items()]
            for task, members in outside[0].items()
        }
        return digest([self.config.method, code, params, digests])

    def look(
        self,
        files: Files,
        history: History,
        wanted: tuple[str, ...] = (),
        force: Iterable[str] = (),
        made_with: Iterable[str] = (),
        outside: Outside | None = None,
    ) -> Snapshot:
        """What `inspect` gives, with a memory of files and a history that several pipelines on one store share.

        outside : what `look_outside` found for the same tasks; None looks now
        """
        graph = self.tasks.until(wanted) if wanted else self.tasks
        given, notes = outside or origin_artifacts(graph, self.config, files, history)
        schedule = Schedule(
            graph,
            self.config.params,
            self.store,
            given,
            force=[self.tasks.task(name).name for name in force],
            recall=history.recall,
            distrusted=MadeWith.of(made_with),
        )
        return Snapshot(schedule, history, tuple(notes), wanted)

    def run(
        self,
        client: Any = None,
        *,
        until: Iterable[str] = (),
        force: Iterable[str] = (),
        made_with: Iterable[str] = (),
        listeners: Iterable[Listener] = (),
        settling: Settling | None = None,
    ) -> RunSummary:
        """Runs what is out of date; returns the content of run.json and the run's name, in which failed nodes are listed.

        client   : a `distributed.Client` to run on; None runs where the configuration says
        settling : which files of an input that grows are complete; None takes all
        raises   : InputError where the user's input is wrong; KeyboardInterrupt after the store was left whole
        """
        refuse_no_client(client)
        started = time.perf_counter()
        compute = self.config.compute
        if client is None and compute.has_own_workers:
            refuse_within_import()

        def begin() -> None:  # the files are new, so that there will be something to compute
            if client is None and compute.has_own_workers:
                from kinetree.pipeline.running.launch import environment

                parent.begin(environment(compute))

        with WorkerParent(self.worker_setup) as parent, advising(self.store):
            files = Files.of(self.store, settling, unknown=begin)
            there = self._snapshot(files, tuple(until) or self.tasks.unasked, force, made_with)
            raise_swallowed()  # before anything is put on record and workers start
            session = Session.begin(self.config, there, listeners, started=started, told_of=self.described())
            files.save()
            status: Status = "interrupted"
            try:
                self._go(there, session.watch, client, parent)
                status = session.leave()
            except Exception:
                status = "stopped"
                raise
            finally:
                summed = session.close(status)
            session.write_pages(summed)
            return summed

    def described(self) -> dict[str, Any]:
        """The graph and the configuration, for a page about a run."""
        graph = {t.name: {"over": "/".join(t.over), "reads": [r.name for r in self.tasks.reads(t)]} for t in self.tasks.tasks}
        return {"graph": graph, "config": as_yaml(self.config.saved())}

    def computed(self, name: str, also: Collection[str] = ()) -> Snapshot:
        """Computes one task from what is there and nothing else; returns the snapshot that has its artifacts.

        Where the store may be read and not written, or is full, what is computed stays in the memory of this process, and
        the snapshot's `unkept` says why.

        also   : tasks before it that are computed where they are out of date
        raises : UnknownNodeError where something it reads is not there; NodesFailedError where it fails itself
        """
        try:
            return self._computed(name, also)
        except (ReadOnlyStoreError, StoreFullError) as error:
            config = replace(self.config, compute=Compute(executor="sync"))  # no other process sees that memory
            there = replace(self, config=config, store=self.store.unwritten())._computed(name, also)
            return replace(there, unkept=f"{error}; computed in memory, nothing is kept")

    def _computed(self, name: str, also: Collection[str]) -> Snapshot:
        there = self.inspect(until=[name])
        self._refuse_missing(there, name, also)
        account = Account()
        self._go(there, Watch((account,)), None)
        if account.failures:
            failure = account.failures[0]
            raise NodesFailedError(f"{failure['node']}: {failure['error']}: {failure['message']}")
        return Snapshot(there.schedule, there.history, there.notes, there.named)

    def _refuse_missing(self, there: Snapshot, name: str, also: Collection[str]) -> None:
        stale = [node for node in there.plan.nodes if node.state != "fresh"]
        computed = {name, *(node.task for node in stale if node.task in also)}
        reads = {read.name for task in computed for read in self.tasks.reads(self.tasks.task(task))}
        todo = [node for node in stale if node.task not in computed]
        missing = [node.node for node in todo if node.task in reads]
        if missing:
            more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
            first = next((node for node in todo if node.state == "stale"), todo[0])
            where = f"{name} is made from {missing[0]}{more}, which has no up-to-date result"
            raise UnknownNodeError(f"{where}: {first}; kinetree run computes what is missing")

    def graph(self, *, expanded: bool = False) -> "DrawnGraph":
        """The graph of tasks, or expanded of nodes; each node's `data` is a TaskPlan or Planned, edges name arguments."""
        there = self.inspect()
        return there.nodes if expanded else there.graph

    def why(self, node: str) -> Planned:
        """The state of one node and the reason for it; raises UnknownNodeError."""
        return self.inspect().why(node)

    def lineage(self, node: str) -> "DrawnGraph":
        """The part of the graph of nodes from which this node is made and which is made from it."""
        return self.inspect().lineage(node)

    @typed_by_name
    def artifact(self, what: type[Artifact] | str, **index: int) -> Artifact:
        """One artifact, as `Snapshot.artifact` gives it; who wants several asks `inspect()` once."""
        return self.inspect(until=[self.tasks.writer(what).name]).artifact(what, **index)

    def remarks(self) -> list[tuple[str, str]]:
        """What the results that stand for the whole sequence have to say, as (node, sentence)."""
        return self.inspect().remarks()

    def runs(self) -> RunList:
        """Every run on record in this store, oldest first."""
        return RunList(History.of(self.store, self.config).runs())

    def diff(self, run_a: str, run_b: str) -> Difference:
        """What differs between two runs, and from where: nodes whose inputs agree but whose artifacts do not."""
        return Difference(difference(self.store, self.store.run(run_a), self.store.run(run_b)))

    def _go(self, there: Snapshot, watch: Watch, client: Any, parent: WorkerParent | None = None) -> None:
        """Starts workers only where there is something to run."""
        schedule = there.schedule
        if schedule.is_idle:
            return
        from kinetree.pipeline.running.jobs import Job
        from kinetree.pipeline.running.launch import launcher
        from kinetree.pipeline.running.losses import take_back_lost
        from kinetree.pipeline.running.run import run

        raise_swallowed()  # by what was imported just now
        is_whole, beside = False, self.beside if client is None and self.config.compute.is_here else None
        while not is_whole:
            with helped(beside), launcher(self.config.compute, client, parent) as launch:
                run(schedule, launch, watch, Needs.of(there.history.records().values() if launch.is_elsewhere else ()))
            # to end workers takes seconds, in which somebody may have removed what was there
            is_whole = not launch.is_elsewhere or not take_back_lost(Job(schedule, watch), schedule.store)
