"""What a product tells the loom about itself: its graphs, its presets, its commands. Cheap to import, and so is making one.

A product makes one `Application`, passes it to `kinetree.pipeline.command_line.cli.main` in its console script and names it
in the entry point group `kinetree.application`, so that `Pipeline.of` finds it.
"""

import contextlib
import importlib
from collections.abc import Callable, Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any

from kinetree.errors import ConfigError

if TYPE_CHECKING:
    from kinetree.pipeline.graph import Graph

ENTRY_POINTS = "kinetree.application"


@dataclass(frozen=True)
class Command:
    """One command of the command line; its module is imported when it is called or asked for its own help."""

    name: str
    summary: str
    """What it does, in one line; the first line of the function's docstring."""
    function: str
    """Where it is, as module:function; a function as typer takes it."""
    examples: tuple[str, ...] = ()
    """Whole command lines."""
    takes_shortcuts: bool = False
    """Whether it has the application's shortcuts among its options; its function then takes `sets`."""

    def imported(self) -> Callable[..., Any]:
        """The function."""
        return _imported(self.function)


@dataclass(frozen=True)
class Section:
    """Commands that stand together in the help."""

    title: str
    commands: tuple[Command, ...]


@dataclass(frozen=True)
class Shortcut:
    """An option that sets one parameter, for those that are set most often."""

    options: tuple[str, ...]
    """As they are typed, the long one first: ("--input", "-i")."""
    parameter: str
    """As --set takes it: task.name."""
    help: str
    metavar: str = "TEXT"
    is_input: bool = False
    """Whether a run needs no configuration where this is given."""


@dataclass(frozen=True)
class Application:
    """A product that runs on the loom."""

    name: str
    """The command, and the distribution whose version it prints."""
    summary: str
    """What it does, in a sentence or two; the head of its help."""
    methods: Callable[[], Mapping[str, "Graph"]]
    """Imports and gives the graphs by name; the first is the default."""
    presets: str | None = None
    """The package that holds presets as YAML files, and compute settings in its folder `compute`."""
    sections: tuple[Section, ...] = ()
    """The commands, in the order of the help."""
    shortcuts: tuple[Shortcut, ...] = ()
    data_sets: 'Callable[[], "Graph"] | None' = None
    """Imports and gives the graph that sums up a data set, over the dimension `sequence`: `linked` tasks give the artifacts of
    every sequence that was computed; one origin, whose params have the field `sequences`, lists what became of all."""
    renamed: Mapping[str, str] = field(default_factory=dict)
    """What blocks and parameters (as task.name) of earlier versions are called now; what refuses the old name says so."""
    beside: str | None = None
    """What helps a run that computes on this machine from the side, as module:function: gives a context manager that lasts as
    long as the run and changes no result."""
    worker_setup: str | None = None
    """What every worker process of this machine needs and can be loaded before there is work, as module:function; called in the
    process that they are forked from. Changes no result."""
    first_steps: tuple[tuple[str, str], ...] = ()
    """Command lines to begin with and what each does; printed where no command is named."""

    @property
    def commands(self) -> dict[str, Command]:
        """The commands by name, in the order of the help."""
        return {command.name: command for section in self.sections for command in section.commands}

    @contextlib.contextmanager
    def active(self) -> Iterator[None]:
        """Makes this the application that `current` gives inside the block."""
        token = _active.set(self)
        try:
            yield
        finally:
            _active.reset(token)


_active: ContextVar[Application | None] = ContextVar("application", default=None)


def current() -> Application:
    """The application whose command line is running; in any other program the one that is installed.

    raises : ConfigError where not exactly one is installed
    """
    return _active.get() or _installed()


def helped(place: str | None) -> contextlib.AbstractContextManager[None]:
    """What an application has beside a run (`Application.beside`); nothing for None."""
    helper: contextlib.AbstractContextManager[None] = _imported(place)() if place else contextlib.nullcontext()
    return helper


def _installed() -> Application:
    points = entry_points(group=ENTRY_POINTS)
    if not points:
        raise ConfigError(
            f"entry point group {ENTRY_POINTS}: expected one application, found none: the package was installed before it named"
            " one; install it again (pip install .), delete *.egg-info folders beside its code, or pass one with application=…"
        )
    if len(points) > 1:
        names = ", ".join(sorted(point.name for point in points))
        raise ConfigError(
            f"entry point group {ENTRY_POINTS}: expected one application, found {names}; pass one with application=…"
        )
    (point,) = points
    try:
        application: Application = point.load()
    except (ImportError, AttributeError) as error:
        raise ConfigError(
            f"entry point {point.name} = {point.value}: cannot be imported: {error}; install the package again (pip install .)"
        ) from error
    return application


def _imported(place: str) -> Callable[..., Any]:
    """The function at module:function."""
    module, _, name = place.partition(":")
    function: Callable[..., Any] = getattr(importlib.import_module(module), name)
    return function


def built_in(name: str, *examples: str) -> Command:
    """One of the loom's own commands, with examples in the product's words; raises KeyError."""
    module, summary = _BUILT_IN[name]
    function = f"kinetree.pipeline.command_line.{module}:{name}"
    return Command(name, summary, function, examples, takes_shortcuts=name in ("run", "plan"))


_BUILT_IN = {
    "run": ("commands", "Run the steps that are out of date and say where the results are."),
    "dataset": ("dataset_commands", "Run, plan or look at many sequences with one configuration."),
    "gc": ("commands", "Delete from the store what no longer belongs to a run you keep."),
    "verify": ("commands", "Read all of a store and say what is damaged; with --repair, compute that again."),
    "plan": ("queries", "Say what a run would compute and why, without computing anything."),
    "show": ("queries", "Show what a node holds and how it was made."),
    "why": ("queries", "Say whether a node is up to date and why."),
    "graph": ("queries", "Draw the graph of tasks as text."),
    "tasks": ("queries", "List every task with its inputs, output and parameters."),
    "runs": ("queries", "List the runs recorded in the store, oldest first."),
    "diff": ("queries", "Say what differs between two runs and where it starts."),
    "config": ("queries", "Print every parameter with its value and meaning, as YAML."),
}
"""Module and summary of the loom's own commands."""
