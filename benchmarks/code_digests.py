"""Which tasks an edit makes stale, by modules and by definitions.

    python benchmarks/code_digests.py [COMMIT ...] [--last 20] [--verify COMMIT ...] [--edits]

Prints one table. Each commit is compared with its parent from the texts in git alone. By modules, the digest of a task covers
the modules that its own imports, transitively, as it did before; by definitions, what its function reaches by name.
--verify runs both trees of a commit over one small generated sequence and compares, bit by bit, the arrays and values of
every task that is stale by modules and not by definitions. --edits makes typical edits of today's code instead, in memory.
"""

import argparse
import ast
import io
import json
import os
import re
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

from kinetree.pipeline.definitions import Code
from kinetree.pipeline.key import HARMLESS
from kinetree.pipeline.modules import PACKAGE
from kinetree.pipeline.statements import syntax

ROOT = Path(__file__).parent.parent
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
    parser.add_argument("--edits", action="store_true", help="typical edits instead of commits")
    asked = parser.parse_args()
    if asked.edits:
        edits()
        return
    print(f"{'commit':9} {'modules':>8} {'definitions':>11}  no longer stale")
    for commit in asked.commits or _commits(asked.last):
        before, after = texts_of(f"{commit}^"), texts_of(commit)
        old, new = stale(before, after, by_modules), stale(before, after, by_definitions)
        if new - old:
            raise SystemExit(f"{commit}: stale by definitions alone: {', '.join(sorted(new - old))}")
        print(f"{commit[:9]} {len(old):8} {len(new):11}  {_listed(old - new)}", flush=True)
        if asked.verify and old - new:
            print(f"{'':31}{verified(commit, old - new)}", flush=True)


def edits() -> None:
    """Prints how many tasks each typical edit makes stale."""
    before = texts_in(ROOT)
    total = len(tasks_of(before))
    print(f"{'edit':48} {'modules':>8} {'definitions':>11}  of {total} tasks")
    for what, module, old, new in EDITS:
        found = next((name for name in (f"kinetree.{module}", f"kinetree.{module}{PACKAGE}") if name in before), None)
        pattern = old if "(" in old and "\\" in old else re.escape(old)
        changed, count = (
            re.subn(pattern, new if "\\g" in new else lambda _, n=new: n, before[found], count=1, flags=re.DOTALL)
            if found
            else ("", 0)
        )
        if not count:
            print(f"{what:48} {'no such text in ' + module:>20}")
            continue
        after = {**before, str(found): changed}
        print(f"{what:48} {len(stale(before, after, by_modules)):8} {len(stale(before, after, by_definitions)):11}")


def stale(before: Texts, after: Texts, rule: Callable[[Texts], dict[str, object]]) -> set[str]:
    """The tasks of both trees, by name, whose digest an edit changes."""
    a, b = rule(before), rule(after)
    return {task for task in a if task in b and a[task] != b[task]}


def by_modules(texts: Texts) -> dict[str, object]:
    """What the digest of each task covered before: all modules it imports, transitively."""
    code = Code(texts, HARMLESS)
    found: dict[str, object] = {}
    for task, home in tasks_of(texts).items():
        covered: dict[str, str] = {}
        waiting = [home]
        while waiting:
            module = waiting.pop()
            if module not in covered:
                covered[module] = _whole(texts.get(module) or texts[f"{module}{PACKAGE}"])
                waiting += code.imports(module)
        found[task] = covered
    return found


@cache
def _whole(text: str) -> str:
    return syntax(ast.parse(text))


def by_definitions(texts: Texts) -> dict[str, object]:
    """What the digest of each task covers."""
    code = Code(texts, HARMLESS)
    return {task: code.reached(home, task) for task, home in tasks_of(texts).items()}


def tasks_of(texts: Texts) -> Tasks:
    """The tasks of a tree, with their modules: functions that are decorated as a task or an origin."""
    found: Tasks = {}
    for name, text in texts.items():
        if not name.startswith("kinetree.tasks") or not re.search(r"^@(task|origin)\b", text, re.MULTILINE):
            continue
        module = name.removesuffix(PACKAGE)
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef):
                words = {ast.unparse(d).partition("(")[0] for d in node.decorator_list}
                found |= {node.name: module} if words & {"task", "origin"} else {}
    return found


@cache
def texts_of(commit: str) -> Texts:
    """The modules of a commit's tree, as its own pyproject lays them out."""
    with tempfile.TemporaryDirectory() as folder:
        _unpacked(commit, Path(folder))
        return texts_in(Path(folder))


def texts_in(folder: Path) -> Texts:
    """The modules of a tree that lies in a folder."""
    layout = tomllib.loads((folder / "pyproject.toml").read_text())["tool"]["setuptools"]["package-dir"]
    found: dict[str, str] = {}
    for package, place in layout.items():
        if package.startswith(COUNTED):
            for path in (folder / place).glob("*.py"):
                found[f"{package}.{path.stem}"] = path.read_text()
    return found


def verified(commit: str, tasks: set[str]) -> str:
    """Runs both trees of a commit on one generated sequence; says which of the tasks gave what."""
    with tempfile.TemporaryDirectory() as folder:
        told = []
        scans = Path(folder) / "scans"
        for side, name in (("before", f"{commit}^"), ("after", commit)):
            tree = Path(folder) / side
            _unpacked(name, tree)
            told.append(_results(tree, scans, Path(folder) / f"out-{side}"))
    before, after = told
    seen = {node: (before[node], after[node]) for node in before.keys() & after.keys() if node.partition("[")[0] in tasks}
    ran = {node.partition("[")[0] for node in seen}
    differing = {node.partition("[")[0] for node, (a, b) in seen.items() if a != b}
    missing = tasks - ran
    return (
        f"ran {len(ran)} of {len(tasks)}: {len(differing)} with other results"
        + (f" ({_listed(differing)})" if differing else "")
        + (f"; not run: {_listed(missing)}" if missing else "")
    )


def _results(tree: Path, scans: Path, output: Path) -> dict[str, str]:
    """The artifact digest of every node of one tree, over the sequence, which the first tree makes."""
    home = tree / "installed"
    layout = tomllib.loads((tree / "pyproject.toml").read_text())["tool"]["setuptools"]["package-dir"]
    (home / "kinetree").mkdir(parents=True)
    for package, place in sorted(layout.items()):
        if package.count(".") == 1:
            (home / "kinetree" / package.rpartition(".")[2]).symlink_to(tree / place)
    env = {**os.environ, "PYTHONPATH": str(home), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    begin = "import sys; sys.meta_path[:] = [f for f in sys.meta_path if '__editable__' not in getattr(f, '__module__', '')]; "
    call = [sys.executable, "-c", f"{begin}from kinetree.pipeline.cli import main; main()"]
    if not scans.exists():
        made = subprocess.run(
            [*call, "synth", "-o", str(scans), "--frames", "6", "--vertices", "1500"], env=env, capture_output=True, text=True
        )
        if made.returncode:
            raise SystemExit(f"{tree.name}: {made.stderr.strip()}")
    subprocess.run(
        [*call, "run", "-i", str(scans), "-o", str(output), "--executor", "sync", "-q"], env=env, capture_output=True
    )
    told = subprocess.run([*call, "plan", str(output), "--nodes", "--json"], env=env, capture_output=True, text=True)
    nodes = json.loads(told.stdout)["nodes"]
    return {node["node"]: node["artifact"] for node in nodes if node.get("artifact")}


def _unpacked(commit: str, folder: Path) -> None:
    """The tree of a commit in a folder."""
    data = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, capture_output=True).stdout
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        archive.extractall(folder, filter="data")


def _commits(count: int) -> list[str]:
    asked = ["git", "log", "--format=%H", f"-{count}", "--", "tasks/*.py", "schemas/*.py"]
    return subprocess.run(asked, cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()


def _listed(names: set[str]) -> str:
    shown = sorted(names)
    return ", ".join(shown[:12]) + (f" and {len(shown) - 12} more" if len(shown) > 12 else "")


if __name__ == "__main__":
    main()
