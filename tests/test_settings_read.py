"""A setting makes stale the nodes of those tasks that read it, and of no others."""

import ast
import builtins
import inspect
import textwrap
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.planning.freshness import asked_params
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
        elif isinstance(node, ast.Call):
            for other, name in handed_on(node, argument, function):
                names |= {"model_dump"} if inspect.isbuiltin(other) else read_by(other, name, kind)
    return names | (set(kind.model_fields) if "model_dump" in names else set())


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
def test_a_changed_setting_is_in_the_keys_of_the_tasks_whose_class_has_it_alone(method: str) -> None:
    graph, params = METHODS[method], Pipeline.of({"method": method}).config.params
    for owner in (task for task in graph.tasks if task.sets is not None):
        for field in owner.sets.model_fields:
            changed = {**params, owner.name: params[owner.name].model_copy(update={field: "another"})}
            stale = {t.name for t in graph.tasks if str(asked_params(t, params)) != str(asked_params(t, changed))}
            readers = {t.name for t in graph.tasks if t.params and t.block == owner.name and field in t.params.model_fields}
            assert stale == readers != set(), f"{owner.name}.{field}"
