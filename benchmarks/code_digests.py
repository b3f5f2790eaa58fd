"""Which tasks an edit makes stale, by modules and by definitions.

    python benchmarks/code_digests.py [COMMIT ...] [--last 20] [--verify COMMIT ...] [--edits]

Prints one table. Each commit is compared with its parent from the texts in git alone. By modules, the digest of a task covers
the modules that its own imports, transitively, as it did before; by definitions, what its function reaches by name.
--verify runs both trees of a commit over one small generated sequence and compares, bit by bit, what every node made that had
equal inputs and parameters in both: a task that then makes something else and is not stale by definitions is MISSED.
--edits makes typical edits of today's code instead, in memory.
"""

import argparse
import ast
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from kinetree.pipeline.identity.definitions import Code
from kinetree.pipeline.identity.modules import PACKAGE
from kinetree.pipeline.identity.own_code import HARMLESS
from kinetree.pipeline.identity.statements import syntax
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.records import Records
from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.input.synth import write_sequence

ROOT = Path(__file__).parent.parent
LIMIT = 900
"""Seconds that the run of one tree may take."""
COUNTED = ("kinetree.tasks", "kinetree.schemas")
Texts = Mapping[str, str]
Tasks = dict[str, str]

EDITS = (
    ("a word in a warning", "tasks.views.registration", "reference", "Reference"),
    ("one character in what is told of a skeleton", "tasks.views.structure", "bone {", "bone: {"),
    ("a new dimension", "schemas.dims", 'FACE = Dim("face")', 'FACE = Dim("face")\nEDGE = Dim("edge")'),
    (
        "a constant of the synthetic generator",
        "tasks.numerics.input.synth.body",
        "_SURFACE, _NOISE, _HOLES, _REST = range(4)",
        "_SURFACE, _NOISE, _HOLES, _REST = range(1, 5)",
    ),
    (
        "a formula of the geodesic front",
        "tasks.numerics.geometry.bucketed_dijkstra",
        "np.uint64(BANDS - 1)",
        "np.uint64(BANDS - 2)",
    ),
    ("a docstring", "tasks.numerics.geometry.bucketed_dijkstra", '"""', '"""Reworded. '),
    ("a comment", "tasks.numerics.geometry.bucketed_dijkstra", "\n\n\n", "\n\n\n# why\n"),
    ("a default of the mesh's parameters", "schemas.input.mesh", r"(class MeshParams.*?: float = )[\d.e-]+", r"\g<1>0.123"),
    (
        "a new helper that nothing uses",
        "tasks.numerics.input.mesh",
        "\n\n\ndef ",
        "\n\n\ndef spare(x):\n    return x\n\n\ndef ",
    ),
    (
        "a colour of a plot",
        "tasks.results.plots.mesoscopic",
        "BLACK, WHITE = to_rgba(",
        'BLACK, WHITE = to_rgba("0.1") or to_rgba(',
    ),
)
"""What is edited, in which module, the text or pattern, and what replaces its first occurrence."""


def main() -> None:
    """Prints the table that was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commits", nargs="*", help="default: the last that touch code of tasks or schemas")
    parser.add_argument("--last", type=int, default=20)
    parser.add_argument("--verify", action="store_true", help="run both trees and compare")
    parser.add_argument("--frames", type=int, default=4, help="of the generated sequence")
    parser.add_argument("--vertices", type=int, default=900, help="of the generated sequence")
    parser.add_argument("--edits", action="store_true", help="typical edits instead of commits")
    asked = parser.parse_args()
    if asked.edits:
        edits()
        return
    with tempfile.TemporaryDirectory() as folder:
        frames = Path(folder) / "frames"
        if asked.verify:
            write_sequence(SynthParams(frames=asked.frames, vertices=asked.vertices), frames)
        print(f"{'commit':9} {'modules':>8} {'definitions':>11}  no longer stale")
        for commit in asked.commits or _commits(asked.last):
            before, after = texts_of(f"{commit}^"), texts_of(commit)
            old, new = stale(before, after, by_modules), stale(before, after, by_definitions)
            print(f"{commit[:9]} {len(old):8} {len(new):11}  {_listed(old - new)}", flush=True)
            if new - old:
                print(f"{'':31}stale by definitions alone: {_listed(new - old)}", flush=True)
            if asked.verify:
                print(f"{'':31}{verified(commit, new, frames)}", flush=True)


def edits() -> None:
    """Prints how many tasks each typical edit makes stale."""
    before = texts_in(ROOT)
    total = len(tasks_of(before))
    print(f"{'edit':48} {'modules':>8} {'definitions':>11}  of {total} tasks")
    for what, module, old, new in EDITS:
        full_name = next((name for name in (f"kinetree.{module}", f"kinetree.{module}{PACKAGE}") if name in before), None)
        pattern = old if "(" in old and "\\" in old else re.escape(old)
        changed, count = (
            re.subn(pattern, new if "\\g" in new else lambda _, n=new: n, before[full_name], count=1, flags=re.DOTALL)
            if full_name
            else ("", 0)
        )
        if not count:
            print(f"{what:48} {'no such text in ' + module:>20}")
            continue
        after = {**before, str(full_name): changed}
        print(f"{what:48} {len(stale(before, after, by_modules)):8} {len(stale(before, after, by_definitions)):11}")


def stale(before: Texts, after: Texts, rule: Callable[[Texts], dict[str, object]]) -> set[str]:
    """The tasks of both trees, by name, whose digest an edit changes."""
    a, b = rule(before), rule(after)
    return {task for task in a if task in b and a[task] != b[task]}


def by_modules(texts: Texts) -> dict[str, object]:
    """What the digest of each task covered before: all modules it imports, transitively."""
    code = Code(texts, HARMLESS)
    digests: dict[str, object] = {}
    for task, home in tasks_of(texts).items():
        covered: dict[str, str] = {}
        waiting = [home]
        while waiting:
            module = waiting.pop()
            if module not in covered:
                covered[module] = _whole(texts.get(module) or texts[f"{module}{PACKAGE}"])
                waiting += code.imports(module)
        digests[task] = covered
    return digests


@cache
def _whole(text: str) -> str:
    return syntax(ast.parse(text))


def by_definitions(texts: Texts) -> dict[str, object]:
    """What the digest of each task covers."""
    code = Code(texts, HARMLESS)
    return {task: code.reached(home, task) for task, home in tasks_of(texts).items()}


def tasks_of(texts: Texts) -> Tasks:
    """The tasks of a tree, with their modules: functions that are decorated as a task or an origin."""
    homes: Tasks = {}
    for name, text in texts.items():
        if not name.startswith("kinetree.tasks") or not re.search(r"^@(task|origin)\b", text, re.MULTILINE):
            continue
        module = name.removesuffix(PACKAGE)
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef):
                words = {ast.unparse(d).partition("(")[0] for d in node.decorator_list}
                homes |= {node.name: module} if words & {"task", "origin"} else {}
    return homes


@cache
def texts_of(commit: str) -> Texts:
    """The modules of a commit's tree, as its own pyproject lays them out."""
    with tempfile.TemporaryDirectory() as folder:
        _unpacked(commit, Path(folder))
        return texts_in(Path(folder))


def texts_in(folder: Path) -> Texts:
    """The modules of a tree that lies in a folder."""
    layout = tomllib.loads((folder / "pyproject.toml").read_text())["tool"]["setuptools"]["package-dir"]
    texts: dict[str, str] = {}
    for package, place in layout.items():
        if package.startswith(COUNTED):
            for path in (folder / place).glob("*.py"):
                texts[f"{package}.{path.stem}"] = path.read_text()
    return texts


@dataclass(frozen=True)
class Outcome:
    """What one tree made of the sequence."""

    failure: str
    """Why its run did not come to its end; "" where it did."""
    artifacts: Mapping[str, str]
    """By task, index, parameters and the digests of its inputs, the digest of the artifact of a node."""


def verified(commit: str, stale_by_definitions: set[str], frames: Path) -> str:
    """One line: nodes that ran on equal inputs, tasks that made other results of them, tasks that the rule missed."""
    parent = _git("rev-parse", f"{commit}^").strip()
    before, after = (outcome(_git("rev-parse", f"{name}^{{tree}}").strip(), frames) for name in (parent, commit))
    failures = [f"{side}: {tree.failure}" for side, tree in (("parent", before), ("commit", after)) if tree.failure]
    equal = before.artifacts.keys() & after.artifacts.keys()
    ran = {_task(node) for node in after.artifacts}
    compared = {_task(node) for node in equal}
    differing = {_task(node) for node in equal if before.artifacts[node] != after.artifacts[node]}
    missed = differing - stale_by_definitions
    return "; ".join(
        [
            f"{len(equal)} of {len(after.artifacts)} nodes had equal inputs",
            f"{len(compared - stale_by_definitions)} of {len(ran - stale_by_definitions)} tasks that are not stale compared",
            f"other results of {_listed(differing) or 'no task'}",
            f"MISSED {_listed(missed)}" if missed else "none missed",
            *failures,
        ]
    )


def _task(node: str) -> str:
    return str(json.loads(node)[0])


@cache
def outcome(tree: str, frames: Path) -> Outcome:
    """Runs one tree of the history over the sequence, in a process of its own."""
    place = frames.parent / "tree"  # always the same, since what numba compiled is found again by its path
    with _removed(place):
        output = place / "output"
        _unpacked(tree, place)
        call, env = _program(place)
        try:
            done = subprocess.run(
                [*call, "run", "--input", str(frames), "--output", str(output), "--executor", "sync", "--quiet"],
                env=env, capture_output=True, text=True, timeout=LIMIT,
            )  # fmt: skip
            failure = f"exit {done.returncode}: {' '.join(done.stderr.split())[-200:]}" if done.returncode else ""
        except subprocess.TimeoutExpired:
            failure = f"stopped after {LIMIT} s"
        artifacts = {
            json.dumps([r["task"], r["index"], r["params"], r["inputs"]], sort_keys=True): r["artifact"]
            for r in _records(output / "store")
        }
    return Outcome(failure, artifacts)


def _records(store: Path) -> list[dict[str, Any]]:
    """The records of a store, which commits before the packed ones kept in files of their own."""
    single = [json.loads(path.read_bytes()) for path in store.glob("records/*/*.json")]
    return single or [asdict(record) for record in Records(Folder(store)).all()]


@contextmanager
def _removed(folder: Path) -> Iterator[None]:
    try:
        yield
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _program(place: Path) -> tuple[list[str], dict[str, str]]:
    """The command and the environment that run the kinetree of a tree and nothing of the one that is installed."""
    home, project = place / "installed", tomllib.loads((place / "pyproject.toml").read_text())
    (home / "kinetree").mkdir(parents=True)
    for package, folder in sorted(project["tool"]["setuptools"]["package-dir"].items()):
        if package.count(".") == 1:
            (home / "kinetree" / package.rpartition(".")[2]).symlink_to(place / folder)
    module, _, function = project["project"]["scripts"]["kinetree"].partition(":")
    begin = "import sys; sys.meta_path[:] = [f for f in sys.meta_path if '__editable__' not in getattr(f, '__module__', '')]"
    threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return (
        [sys.executable, "-c", f"{begin}; from {module} import {function} as main; main()"],
        {**os.environ, "PYTHONPATH": str(home), **threads},
    )


def _unpacked(commit: str, folder: Path) -> None:
    """The tree of a commit in a folder."""
    folder.mkdir(exist_ok=True)
    data = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, capture_output=True).stdout
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        archive.extractall(folder, filter="data")


def _commits(count: int) -> list[str]:
    return _git("log", "--format=%h", f"-{count}", "--no-merges", "--", "tasks/*.py", "schemas/*.py").split()


def _git(*words: str) -> str:
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def _listed(names: set[str]) -> str:
    ordered = sorted(names)
    return ", ".join(ordered[:12]) + (f" and {len(ordered) - 12} more" if len(ordered) > 12 else "")


if __name__ == "__main__":
    main()
