"""A setting makes stale the nodes of those tasks that read it, and of no others."""

import ast
import builtins
import inspect
import textwrap
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.freshness import Freshness
from kinetree.pipeline.planning.made_with import EVERY_VERSION_TRUSTED
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.array import Params
from kinetree.tasks.methods import METHODS

TASKS = {task.name: task for graph in METHODS.values() for task in graph.tasks if task.params is not None}


def read_by(function: Callable[..., Any], argument: str, kind: type[Params]) -> set[str]:
    """Fields that a function reads of an argument, also where it hands it on; all where that cannot be followed."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == argument:
            method = inspect.getattr_static(kind, node.attr, None)
            method = method.fget if isinstance(method, property) else method
            is_own = inspect.isfunction(method) and method.__module__.startswith("kinetree")
            names |= read_by(method, "self", kind) if is_own else {node.attr}
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == f"{argument}.model_dump":
            names |= dumped(node, kind)
        elif isinstance(node, ast.Call):
            for other, name in handed_on(node, argument, function):
                names |= set(kind.model_fields) if inspect.isbuiltin(other) else read_by(other, name, kind)
    return names & set(kind.model_fields)


def dumped(call: ast.Call, kind: type[Params]) -> set[str]:
    """Fields that a call of `model_dump` gives, those of a set that is not written out among them."""
    names = set(kind.model_fields)
    for keyword in call.keywords:
        if keyword.arg in ("include", "exclude") and isinstance(keyword.value, ast.Set):
            written = {str(each.value) for each in keyword.value.elts if isinstance(each, ast.Constant)}
            names = names & written if keyword.arg == "include" else names - written
    return names


def handed_on(call: ast.Call, argument: str, function: Callable[..., Any]) -> Iterator[tuple[Callable[..., Any], str]]:
    """The function that is called with the argument, and what it calls it."""
    places: list[int | str | None] = [k for k, a in enumerate(call.args) if isinstance(a, ast.Name) and a.id == argument]
    places += [a.arg for a in call.keywords if isinstance(a.value, ast.Name) and a.value.id == argument]
    for place in places:
        first, *parts = ast.unparse(call.func).split(".")
        other: Any = function.__globals__.get(first, vars(builtins).get(first))
        for part in parts:
            other = getattr(other, part)
        other = inspect.unwrap(other)
        is_named = not isinstance(place, int)
        yield other, str(place) if is_named or inspect.isbuiltin(other) else list(inspect.signature(other).parameters)[place]


@pytest.mark.parametrize("name", TASKS)
def test_a_task_reads_all_settings_that_are_in_its_keys(name: str) -> None:
    task = TASKS[name]
    unread = set(task.params.model_fields) - read_by(task.function, "params", task.params)
    assert not unread, f"{name} does not read {', '.join(sorted(unread))}"


@pytest.mark.filterwarnings("ignore:Pydantic serializer warnings")
@pytest.mark.parametrize("method", METHODS)
def test_a_changed_setting_changes_the_keys_of_the_tasks_that_read_it_and_of_no_others(method: str, tmp_path: Path) -> None:
    graph, params = METHODS[method], Pipeline.of({"method": method}).config.params
    before = keys(graph, params, tmp_path)
    reads = {t.name: read_by(t.function, "params", t.params) for t in graph.tasks if t.params is not None}
    for owner in (task for task in graph.tasks if task.sets is not None):
        for field in owner.sets.model_fields:
            changed = {**params, owner.name: params[owner.name].model_copy(update={field: "another"})}
            after = keys(graph, changed, tmp_path)
            stale = {name for name in before if after[name] != before[name]}
            readers = {t.name for t in graph.tasks if t.block == owner.name and field in reads.get(t.name, ())}
            assert stale == readers != set(), f"{owner.name}.{field}"


def keys(graph: Graph, params: Mapping[str, Params], folder: Path) -> dict[str, str]:
    """By task, the key of one node that has no inputs, so that only its own settings can change it."""
    freshness = Freshness(graph, params, Store.at(folder), frozenset(), lambda _: "nothing", EVERY_VERSION_TRUSTED)
    entries = [Entry(Node(task.name, (0,) * len(task.over)), task, task.name, inputs=()) for task in graph.tasks]
    return {entry.task.name: freshness.judged(entry, {})[0] for entry in entries}
