"""How sensitive the result is to each tuned setting: each is halved and doubled, on generated bodies whose truth is known.

    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    python benchmarks/sensitivity.py [--only PATTERN] [--shelves structure registration topology] [--params] [--constants]
                                     [--bodies human quadruped random:0] [--seed 0] [--frames 12] [--vertices 1200]
                                     [--jobs 1] [--minutes M] [--work FOLDER] [--json FILE] [--markdown FILE] [--list]

Settings are the numeric defaults of every `…Settings` value (NamedTuple or frozen dataclass) in kinetree.tasks.numerics that
the default method reaches up to its evaluation. --params adds the numeric parameters of its tasks, --constants the numeric
constants of modules. PATTERN is a regular expression, searched in `shelf/module.Class.field`. With several bodies the first
body measures all settings before the second begins; --minutes begins nothing more after that time and lists what is left.

With --work, a second call goes on where an earlier one stopped: FOLDER keeps the store and, in rows.jsonl, every row. It is
for one state of the code: after an edit, begin with an empty folder.

All runs share one store. A default is changed in the process, which the text of the code does not show: while it
is changed, every task whose code reaches the setting gets a code digest of its own, so that no result is taken for another
and nothing is computed again that cannot change. A setting that is an integer stays at least 1; tuples of numbers are scaled
as a whole; zero and infinity have no half. Shares, confidences and cosines are not doubled past 1. A value that a caller
always gives, or that was fixed when its module was imported, is reported as not varied, since its default is never asked.

Columns: found of scored joints / mean error of those found in % of the height / spurious joints, at half the default, at the
default and at twice the default, summed (error: averaged) over the bodies; joints that appeared or vanished or, if more, by how
many the found and the spurious ones changed; and the largest movement of a joint in any frame, in % of the height, both against
the run with defaults, the larger of half and double.
Sorted by the last two. Joints of two runs are paired by least total distance.
"""

import argparse
import ast
import dataclasses
import importlib
import inspect
import json
import math
import multiprocessing
import os
import pkgutil
import re
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.errors import KinetreeError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.identity.key import digest
from kinetree.pipeline.identity.own_code import code_parts
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.planning import freshness
from kinetree.pipeline.running import execute
from kinetree.tasks import METHODS

NUMERICS = "kinetree.tasks.numerics"
SHELVES = ("structure", "registration", "topology")
"""Shelves that are measured if nothing is said. Input and results say how a result is read and judged, not what it is."""
FACTORS = {"half": 0.5, "double": 2.0}
UNIT_RANGE = ("share", "confidence", "cosine")
"""First words of a setting's docstring that say that it lies between 0 and 1."""
METHOD = next(iter(METHODS))
ROWS = "rows.jsonl"
"""The file in the folder of work that keeps every row."""
Value = Any
"""A number or a tuple of numbers."""


class Setting(NamedTuple):
    """One number that was chosen.

    kind    : a field of a settings value, a parameter of a task, or a constant of a module
    module  : where it is defined; for a parameter the module of its task
    owner   : the settings class, or the task; "" for a constant
    field   : its name
    default : as it ships
    meaning : first sentence of its docstring
    """

    kind: Literal["field", "parameter", "constant"]
    module: str
    owner: str
    field: str
    default: Value
    meaning: str

    @property
    def shelf(self) -> str:
        """The shelf on which it stands."""
        return self.module.removeprefix(f"{NUMERICS}.").removeprefix("kinetree.tasks.").partition(".")[0]

    @property
    def name(self) -> str:
        """shelf/module.Class.field, shelf/task.field or shelf/module.FIELD."""
        place = f"{self.shelf}/{self.module.rpartition('.')[2]}"
        return ".".join((place, *([self.owner] if self.kind == "field" else []), self.field))

    @property
    def definition(self) -> str:
        """What a task's code must reach for the setting to matter to it."""
        return self.owner or self.field


class Body(NamedTuple):
    """A generated body in motion."""

    figure: str
    frames: int
    vertices: int
    seed: int


class Outcome(NamedTuple):
    """What one run found.

    found, scored, spurious : joints
    error                   : mean error of the joints found, % of the height; NaN where none was found
    joints                  : (frame, joint, xyz) as shares of the height
    ran                     : nodes that were computed, by task
    uses                    : how often a settings value was made with the varied default
    why                     : why the run failed; "" if it did not
    """

    found: int
    scored: int
    error: float
    spurious: int
    joints: np.ndarray[Any, np.dtype[np.float64]]
    ran: dict[str, int]
    uses: int = 0
    why: str = ""


class Row(NamedTuple):
    """A setting with what became of it on one body; half and double are an outcome or why there is none."""

    setting: Setting
    body: Body
    default: Outcome
    half: Outcome | str
    double: Outcome | str


def settings(package: str = NUMERICS) -> list[Setting]:
    """Numeric defaults of every class of a package whose name ends in Settings, in the order of modules and of fields."""
    fields = []
    for module in _modules(package):
        for name, cls in vars(module).items():
            if inspect.isclass(cls) and cls.__module__ == module.__name__ and name.endswith("Settings"):
                meanings = _meanings(module.__name__, name)
                for field, default in _defaults(cls).items():
                    if is_numeric(default):
                        fields.append(Setting("field", module.__name__, name, field, default, meanings.get(field, "")))
    return fields


def parameters(graph: Graph) -> list[Setting]:
    """Numeric parameters of the tasks of a graph."""
    numeric = []
    for task in graph.tasks:
        if task.sets is not None and not task.is_origin:
            meanings = _meanings(task.sets.__module__, task.sets.__name__)
            for field, info in task.sets.model_fields.items():
                if is_numeric(info.default):
                    numeric.append(Setting("parameter", task.module, task.name, field, info.default, meanings.get(field, "")))
    return numeric


def constants(package: str = NUMERICS) -> list[Setting]:
    """Numeric constants of the modules of a package, also those of which `fixed_uses` says that they cannot be varied."""
    numeric = []
    for module in _modules(package):
        for statement in _tree(module.__name__).body:
            targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
            for target in targets:
                name = target.id if isinstance(target, ast.Name) else ""
                if re.fullmatch(r"_?[A-Z][A-Z0-9_]*", name) and is_numeric(vars(module).get(name)):
                    numeric.append(Setting("constant", module.__name__, "", name, vars(module)[name], ""))
    return numeric


def is_numeric(value: object) -> bool:
    """Whether a default is a number or a tuple of numbers; truth values are none."""
    if isinstance(value, tuple):
        return bool(value) and all(is_numeric(item) and not isinstance(item, tuple) for item in value)
    return isinstance(value, int | float) and not isinstance(value, bool)


def scaled(setting: Setting, factor: float) -> Value | str:
    """The default times a factor, integers rounded and at least 1; a sentence where that is no other valid value."""
    value = setting.default
    items = value if isinstance(value, tuple) else (value,)
    values = tuple(max(1, round(i * factor)) if isinstance(i, int) else i * factor for i in items)
    is_mark = any(isinstance(i, int) and i < 1 for i in items)
    if values == items or is_mark or not all(math.isfinite(i) for i in items):
        return f"{value} has no other value at ×{factor:g}"
    if setting.meaning.lower().startswith(UNIT_RANGE) and max(items) <= 1.0 < max(values):
        return f"{max(values):g} is no {setting.meaning.split()[0].lower()}"
    return values if isinstance(value, tuple) else values[0]


@contextmanager
def varied(setting: Setting, value: Value) -> Iterator[Callable[[], int]]:
    """Changes a default, gives every task that reaches it a code digest of its own, and puts all back at the end.

    yields : a function that says how often the default was asked for; 0 for constants and parameters
    """
    with ExitStack() as stack:
        uses = [0]
        if setting.kind == "field":
            cls = vars(importlib.import_module(setting.module))[setting.owner]
            stack.enter_context(_default(cls, setting.field, value, uses))
        elif setting.kind == "constant":
            for module, name in _holders(setting):
                stack.enter_context(_attribute(module, name, value))
        if setting.kind != "parameter":
            stack.enter_context(_own_code_digests(setting, value))
        yield lambda: uses[0]


def reaches(module: str, name: str, setting: Setting) -> bool:
    """Whether the code of a task reaches a setting's definition."""
    return setting.definition in {part.rpartition(":")[0] for part in code_parts(module, name).get(setting.module, "").split()}


def fixed_uses(setting: Setting) -> list[str]:
    """Where a constant is read when it can no longer be changed: in compiled functions, and where modules are imported."""
    places = []
    for module in _modules(NUMERICS):
        name = _name_in(module.__name__, setting)
        for statement in _tree(module.__name__).body if name else ():
            place = f"{module.__name__.rpartition('.')[2]}.{getattr(statement, 'name', '(module)')}"
            if any(isinstance(n, ast.Name) and n.id == name and isinstance(n.ctx, ast.Load) for n in _at_import(statement)):
                places.append(place)
    return places


def pipeline(body: Body, work: Path, sets: Sequence[str] = ()) -> Pipeline:
    """The default method on a body, in the store that all runs share; every process has an output folder of its own."""
    synth = {"figure": body.figure, "frames": body.frames, "vertices": body.vertices, "seed": body.seed}
    folders = {"output": str(work / f"output-{os.getpid()}"), "store": str(work / "store")}
    return Pipeline.of({"source": {"synth": synth}, **folders, "compute": {"executor": "sync"}}, sets=sets)


def outcome(body: Body, work: Path, sets: Sequence[str] = (), until: str = "evaluation") -> Outcome:
    """Runs the default method on a body.

    until : the task that ends the run; with another than `evaluation` there are no joints and nothing is found
    """
    empty = np.zeros((body.frames, 0, 3))
    try:
        method = pipeline(body, work, sets)
        run = method.run(until=[until])
    except KinetreeError as error:
        return Outcome(0, 0, math.nan, 0, empty, {}, why=f"{type(error).__name__}: {error}")
    ran = {task: counts["ran"] for task, counts in run["tasks"].items() if counts["ran"]}
    if run["status"] != "done":
        why = "; ".join(f"{f['node']}: {f['message']}" for f in run["failures"][:1]) or run["status"]
        return Outcome(0, 0, math.nan, 0, empty, ran, why=why)
    if until != "evaluation":
        return Outcome(0, 0, math.nan, 0, empty, ran)
    there = method.inspect(until=[until])
    evaluated: Any = there.artifact(until)
    skeleton: Any = there.artifact("skeleton")
    s = evaluated.summary
    joints = np.asarray(skeleton.positions, np.float64) / evaluated.height
    return Outcome(s.found, s.scored, math.nan if s.percent is None else s.percent, s.spurious, joints, ran)


def measured(setting: Setting, body: Body, default: Outcome, work: Path) -> Row:
    """A setting at half and at double its default on one body."""
    outcomes: dict[str, Outcome | str] = {}
    for side, factor in FACTORS.items():
        value = scaled(setting, factor)
        fixed = fixed_uses(setting) if setting.kind == "constant" else []
        if isinstance(value, str) or fixed:
            outcomes[side] = f"fixed when compiled or imported: {', '.join(fixed)}" if fixed else str(value)
            continue
        sets = [f"{setting.owner}.{setting.field}={value}"] if setting.kind == "parameter" else []
        if setting.kind == "parameter" and isinstance(value, tuple):
            sets = [f"{setting.owner}.{setting.field}={list(value)}"]
        with varied(setting, value) as uses:
            one = outcome(body, work, sets)._replace(uses=uses())
        # where nothing ran the result is from an earlier call, which was interrupted before it wrote the row
        if setting.kind == "field" and one.uses == 0 and one.ran:
            outcomes[side] = "the default is never asked for on this body"
        else:
            outcomes[side] = f"invalid: {one.why}" if one.why and not one.ran else one
    return Row(setting, body, default, outcomes["half"], outcomes["double"])


def movement(a: Outcome, b: Outcome) -> tuple[int, float]:
    """Joints that appeared or vanished, and how far the joints of both moved at most, % of the height.

    Joints are paired by least total of their mean distances over the frames, so that their order does not matter.
    """
    distance = np.linalg.norm(a.joints[:, :, None] - b.joints[:, None], axis=-1)
    pairs = linear_sum_assignment(distance.mean(axis=0))
    changed = a.joints.shape[1] + b.joints.shape[1] - 2 * len(pairs[0])
    return changed, 100.0 * float(distance[:, pairs[0], pairs[1]].max(initial=0.0))


class Effect(NamedTuple):
    """What halving and doubling a setting did, over all bodies that were measured.

    failed   : runs that failed
    changed  : joints that appeared or vanished, or the change of found ones and of spurious ones, the most of any run
    movement : largest movement of a joint, % of the height
    runs     : runs that were compared with the default
    """

    failed: int
    changed: int
    movement: float
    runs: int


def effect(rows: Sequence[Row]) -> Effect:
    """The effect of one setting from its rows."""
    sides = [(row.default, side) for row in rows for side in (row.half, row.double) if isinstance(side, Outcome)]
    moved = [movement(default, side) for default, side in sides if not side.why]
    judged = [abs(a.found - b.found) + abs(a.spurious - b.spurious) for a, b in sides if not b.why]
    return Effect(
        failed=sum(bool(side.why) for _, side in sides),
        changed=max((*judged, *(changed for changed, _ in moved)), default=0),
        movement=max((distance for _, distance in moved), default=0.0),
        runs=len(sides),
    )


def wanted(shelves: Sequence[str], only: str, params: bool, with_constants: bool) -> tuple[list[Setting], list[Setting]]:
    """The settings to vary, in the order of the shelves; and those of these shelves that the default method does not reach."""
    graph = METHODS[METHOD].until(["evaluation"])
    every = settings() + (parameters(graph) if params else []) + (constants() if with_constants else [])
    asked = [s for shelf in shelves for s in every if s.shelf == shelf and re.search(only, s.name)]
    reached = {s: s.kind == "parameter" or any(reaches(t.module, t.name, s) for t in graph.tasks) for s in asked}
    return [s for s in asked if reached[s]], [s for s in asked if not reached[s]]


def measure(bodies: Sequence[Body], every: Sequence[Setting], work: Path, jobs: int, until: float) -> Iterator[Row]:
    """Rows as they come, first those of an earlier call; nothing begins after `until`, seconds of `time.monotonic`."""
    earlier = stored(work / ROWS, every, bodies)
    yield from earlier
    done = {(row.setting, row.body) for row in earlier}
    for body in bodies:
        asked = [setting for setting in every if (setting, body) not in done]
        if not asked or time.monotonic() >= until:
            continue
        default = outcome(body, work)
        if default.why:
            raise SystemExit(f"{body.figure}: the run with defaults failed: {default.why}")
        if jobs == 1:
            for setting in asked:
                if time.monotonic() < until:
                    yield measured(setting, body, default, work)
            continue
        with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as pool:
            tasks = [pool.submit(_measured_in_time, s, body, default, work, until) for s in asked]
            for done in as_completed(tasks):
                row = done.result()
                if row is not None:
                    yield row


def _measured_in_time(setting: Setting, body: Body, default: Outcome, work: Path, until: float) -> Row | None:
    """A row, in another process; None where its time is over."""
    return measured(setting, body, default, work) if time.monotonic() < until else None


def line(row: Row) -> str:
    """A row as one line of JSON, joints and all."""

    def plain(one: Outcome | str) -> Any:
        return one if isinstance(one, str) else {**one._asdict(), "joints": one.joints.tolist()}

    sides = {side: plain(getattr(row, side)) for side in ("default", "half", "double")}
    return json.dumps({"setting": [row.setting.name, row.setting.default], "body": row.body, **sides})


def stored(path: Path, every: Sequence[Setting], bodies: Sequence[Body]) -> list[Row]:
    """The rows of a file of such lines that belong to these settings, with the defaults they have now, and these bodies."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    settings_now = {json.dumps([s.name, s.default]): s for s in every}

    def plain(one: Any, frames: int) -> Any:
        if isinstance(one, str):
            return one
        return Outcome(**{**one, "joints": np.reshape(np.array(one["joints"], np.float64), (frames, -1, 3))})

    rows = []
    for record in map(json.loads, lines):
        setting, body = settings_now.get(json.dumps(record["setting"])), Body(*record["body"])
        if setting is not None and body in bodies:
            rows.append(Row(setting, body, *(plain(record[side], body.frames) for side in ("default", "half", "double"))))
    return rows


HEADS = ("setting", "default", "meaning", "half", "at default", "double", "joints ±", "% moved")


def cells(rows: Sequence[Row]) -> tuple[str, ...]:
    """One line of the table: a setting over all bodies."""
    setting, change = rows[0].setting, effect(rows)
    changed = f"{change.changed}" + (f", {change.failed} failed" if change.failed else "")
    value = setting.default
    default = ", ".join(f"{i:g}" for i in (value if isinstance(value, tuple) else (value,)))
    sides = [_summed([row.half for row in rows]), _summed([row.default for row in rows]), _summed([row.double for row in rows])]
    return (setting.name, default, setting.meaning, *sides, changed, f"{change.movement:.3f}" if change.runs else "–")


def _summed(outcomes: Sequence[Outcome | str]) -> str:
    """Found of scored / error / spurious over bodies; the sentence where there is no outcome at all."""
    known = [one for one in outcomes if isinstance(one, Outcome) and not one.why]
    if not known:
        return "; ".join(dict.fromkeys(one if isinstance(one, str) else f"failed: {one.why}" for one in outcomes))
    errors = [one.error for one in known if not math.isnan(one.error)]
    error = f"{np.mean(errors):.2f}" if errors else "–"
    return f"{sum(o.found for o in known)}/{sum(o.scored for o in known)} / {error} / {sum(o.spurious for o in known)}"


def by_setting(rows: Sequence[Row]) -> list[list[Row]]:
    """Rows of each setting, those with the largest effect first, those without any run last."""
    groups: dict[Setting, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.setting, []).append(row)

    def order(group: list[Row]) -> tuple[bool, int, int, float]:
        change = effect(group)
        return (change.runs == 0, -change.failed, -change.changed, -change.movement)

    return sorted(groups.values(), key=order)


def markdown(rows: Sequence[Row], unmeasured: Sequence[str]) -> str:
    """The table, the settings that moved nothing, those that could not be varied, and what was not measured."""
    groups = by_setting(rows)
    lines = ["| " + " | ".join(HEADS) + " |", "|" + "---|" * len(HEADS)]
    varied_ones = [group for group in groups if effect(group).runs]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in cells(group)) + " |" for group in varied_ones]
    idle = [g for g in varied_ones if effect(g)[:3] == (0, 0, 0.0)]
    both = [all(isinstance(side, Outcome) for row in g for side in (row.half, row.double)) for g in idle]
    still = [g[0].setting.name for g, complete in zip(idle, both, strict=True) if complete]
    one_sided = [g[0].setting.name for g, complete in zip(idle, both, strict=True) if not complete]
    fixed = [f"{g[0].setting.name}: {_summed([r.half for r in g])}" for g in groups if not effect(g).runs]
    for title, names in (
        ("Halved and doubled, moved no joint at all", still),
        ("Halved or doubled, not both, moved no joint at all", one_sided),
        ("Not varied", fixed),
        ("Not measured", unmeasured),
    ):
        lines += ["", f"{title} ({len(names)}):", "", *[f"- {name}" for name in names]]
    return "\n".join(lines) + "\n"


def as_json(rows: Sequence[Row]) -> str:
    """All rows, without the joints."""

    def plain(one: Outcome | str) -> Any:
        if isinstance(one, str):
            return {"skipped": one}
        fields = one._asdict()
        del fields["joints"]
        return {**fields, "error": None if math.isnan(one.error) else one.error}

    records = []
    for row in rows:
        moved = {
            side: movement(row.default, one)
            for side, one in (("half", row.half), ("double", row.double))
            if isinstance(one, Outcome) and not one.why
        }
        sides = {"default": plain(row.default), "half": plain(row.half), "double": plain(row.double)}
        setting = {**row.setting._asdict(), "name": row.setting.name}
        records.append({"setting": setting, "body": row.body._asdict(), **sides, "moved": moved})
    return json.dumps(records, indent=1, ensure_ascii=False)


@cache
def _modules(package: str) -> tuple[Any, ...]:
    """All modules of a package, imported, by name; a module that is no package alone."""
    root = importlib.import_module(package)
    below = pkgutil.walk_packages(root.__path__, f"{package}.") if hasattr(root, "__path__") else ()
    return (root, *(importlib.import_module(name) for name in sorted(info.name for info in below)))


@cache
def _tree(module: str) -> ast.Module:
    return ast.parse(inspect.getsource(importlib.import_module(module)))


def _defaults(cls: type) -> dict[str, object]:
    """The defaults of a NamedTuple or a frozen dataclass, by field."""
    if dataclasses.is_dataclass(cls):
        return {f.name: f.default for f in dataclasses.fields(cls) if f.default is not dataclasses.MISSING}
    return dict(getattr(cls, "_field_defaults", {}))


def _meanings(module: str, name: str) -> dict[str, str]:
    """First sentences of the docstrings of a class's fields, or of lines `field : sentence` of the class's own."""
    cls = next((n for n in _tree(module).body if isinstance(n, ast.ClassDef) and n.name == name), None)
    if cls is None:
        return {}
    meanings = dict(re.findall(r"^\s*(\w+) +: (.+)$", ast.get_docstring(cls) or "", re.MULTILINE))
    for field, text in zip(cls.body, cls.body[1:], strict=False):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(text, ast.Expr):
            meanings[field.target.id] = str(getattr(text.value, "value", ""))
    return {field: re.split(r"(?<=[.;])\s|\.$", " ".join(text.split()))[0].rstrip(".;") for field, text in meanings.items()}


@contextmanager
def _default(cls: Any, field: str, value: Value, uses: list[int]) -> Iterator[None]:
    """Changes the default of one field of a class and counts how often it is asked for."""
    method = "__init__" if dataclasses.is_dataclass(cls) else "__new__"
    original = cls.__dict__[method]
    function = original.__func__ if isinstance(original, staticmethod) else original
    before: tuple[Any, ...] = function.__defaults__
    names = list(inspect.signature(function).parameters)[1:]
    place = len(before) - len(names) + names.index(field)

    def counting(first: Any, *args: Any, **kwargs: Any) -> Any:
        uses[0] += names.index(field) >= len(args) and field not in kwargs
        return function(first, *args, **kwargs)

    function.__defaults__ = (*before[:place], value, *before[place + 1 :])
    setattr(cls, method, staticmethod(counting) if isinstance(original, staticmethod) else counting)
    try:
        yield
    finally:
        function.__defaults__ = before
        setattr(cls, method, original)


@contextmanager
def _attribute(owner: Any, name: str, value: object) -> Iterator[None]:
    before = getattr(owner, name)
    setattr(owner, name, value)
    try:
        yield
    finally:
        setattr(owner, name, before)


@contextmanager
def _own_code_digests(setting: Setting, value: Value) -> Iterator[None]:
    """While a setting is changed, plans and runs tasks that reach it as if their code had been edited."""
    original = freshness.code_digest

    def own(module: str, name: str) -> str:
        code = original(module, name)
        return digest(["varied", code, setting.name, value]) if reaches(module, name, setting) else code

    with _attribute(freshness, "code_digest", own), _attribute(execute, "code_digest", own):
        yield


def _name_in(module: str, setting: Setting) -> str:
    """What a module calls a constant; "" if it does not know it."""
    if module == setting.module:
        return setting.field
    for node in _tree(module).body:
        if isinstance(node, ast.ImportFrom) and node.module == setting.module:
            for alias in node.names:
                if alias.name == setting.field:
                    return alias.asname or alias.name
    return ""


def _holders(setting: Setting) -> list[tuple[Any, str]]:
    """The modules that hold a constant, with what they call it: its own and those that import it."""
    named = [(module, _name_in(module.__name__, setting)) for module in _modules("kinetree.tasks")]
    return [(module, name) for module, name in named if name]


def _at_import(statement: ast.stmt) -> Iterator[ast.AST]:
    """The parts of a statement of a module that are evaluated when it is imported or compiled."""
    if isinstance(statement, ast.FunctionDef):
        if any(isinstance(n, ast.Name) and n.id == "compiled" for d in statement.decorator_list for n in ast.walk(d)):
            yield from ast.walk(statement)
            return
        for default in (*statement.args.defaults, *statement.args.kw_defaults):
            yield from ast.walk(default) if default is not None else ()
    elif isinstance(statement, ast.ClassDef):
        for inner in statement.body:
            yield from _at_import(inner)
    else:
        yield from ast.walk(statement)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", default="", metavar="PATTERN")
    parser.add_argument("--shelves", nargs="*", default=list(SHELVES))
    parser.add_argument("--params", action="store_true")
    parser.add_argument("--constants", action="store_true")
    parser.add_argument("--bodies", nargs="*", default=["human", "quadruped", "random:0"])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--vertices", type=int, default=1200)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=math.inf)
    parser.add_argument("--work", type=Path, metavar="FOLDER")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--markdown", type=Path)
    parser.add_argument("--list", action="store_true")
    args = parser.parse_args()
    until = time.monotonic() + 60.0 * args.minutes
    asked, unreached = wanted(args.shelves, args.only, args.params, args.constants)
    if args.list:
        print(*(f"{s.name} = {s.default}" for s in asked), *(f"{s.name}: not reached" for s in unreached), sep="\n")
        return
    bodies = [Body(figure, args.frames, args.vertices, args.seed) for figure in args.bodies]
    rows: list[Row] = []
    with ExitStack() as stack:
        work = args.work or Path(stack.enter_context(tempfile.TemporaryDirectory()))
        work.mkdir(parents=True, exist_ok=True)
        stored_pairs = {(row.setting, row.body) for row in stored(work / ROWS, asked, bodies)}
        for row in measure(bodies, asked, work, args.jobs, until):
            rows.append(row)
            print(row.body.figure, *cells([row]), sep=" | ", flush=True)
            if (row.setting, row.body) not in stored_pairs:
                with (work / ROWS).open("a", encoding="utf-8") as file:
                    file.write(line(row) + "\n")
            if args.json:
                args.json.write_text(as_json(rows), encoding="utf-8")
    done = {(row.setting, row.body) for row in rows}
    remaining = [f"{s.name} on {b.figure}" for b in bodies for s in asked if (s, b) not in done]
    remaining += [f"{s.name}: the method {METHOD} does not reach it" for s in unreached]
    table = markdown(rows, remaining)
    print(table)
    if args.markdown:
        args.markdown.write_text(table, encoding="utf-8")


if __name__ == "__main__":
    main()
