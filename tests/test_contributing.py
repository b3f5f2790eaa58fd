"""The worked example of CONTRIBUTING.md, followed to the letter in a copy of the repository."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n# (\S+\.py)\n(.*?)```", TEXT, re.DOTALL)
"""Path and content of every new file."""
(PATCH,) = re.findall(r"```diff\n(.*?)```", TEXT, re.DOTALL)
COPIED = ("errors", "pipeline", "tasks", "schemas", "configs", "tests", ".typing", "pyproject.toml")

ONE_AFTER_ANOTHER = """
import json, sys
from kinetree.tasks.application import main
for arguments in json.loads(sys.argv[1]):
    sys.argv[1:] = arguments
    try:
        main()
    except SystemExit as end:
        if end.code:
            raise
"""
"""Runs command lines in one process: each process would import everything anew."""


def patched(patch: str, root: Path) -> None:
    """Applies a unified diff whose hunks give enough context to be found once each."""
    for path, hunks in re.findall(r"^--- a/\S+\n\+\+\+ b/(\S+)\n((?:(?!---).*\n?)*)", patch, re.MULTILINE):
        text = (root / path).read_text(encoding="utf-8")
        for hunk in re.split(r"^@@.*@@.*\n", hunks, flags=re.MULTILINE)[1:]:
            lines = hunk.splitlines()
            before = "\n".join(line[1:] for line in lines if not line.startswith("+"))
            after = "\n".join(line[1:] for line in lines if not line.startswith("-"))
            assert text.count(before) == 1, f"{path}: the context of this hunk is not there once:\n{before}"
            text = text.replace(before, after)
        (root / path).write_text(text, encoding="utf-8")


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("contributing")
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, root / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, root / name)
    for path, content in BLOCKS:
        assert not (root / path).exists()
        (root / path).write_text(content, encoding="utf-8")
    patched(PATCH, root)
    return root


def run(root: Path, *command: str) -> str:
    """Runs Python on the copy, whose packages come before the installed ones; gives what it printed."""
    environment = {**os.environ, "PYTHONPATH": str(root / ".typing")}
    done = subprocess.run([sys.executable, *command], cwd=root, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_copy_is_what_runs(copy: Path) -> None:
    where = run(copy, "-c", "import sys, kinetree.tasks.topology.extent as e; print(sys.modules[e.module].__file__)")
    assert Path(where.strip()).resolve() == copy / "tasks/topology/extent.py"


def test_the_new_operation_keeps_the_laws_of_the_house(copy: Path) -> None:
    new = ["tests/topology/test_extent.py", "tests/numerics/topology/test_extent.py"]
    house = ["tests/test_architecture.py", "tests/schemas/test_schemas.py", "tests/commands/test_plots.py"]
    laws = "extent or shelf or reader or ring or size or help"
    run(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", laws, *new, *house)


def test_the_new_operation_runs_takes_its_parameter_and_is_drawn(copy: Path, tmp_path: Path) -> None:
    out, picture = str(tmp_path / "out"), tmp_path / "extent.png"
    commands = [
        ["run", "demo", "--output", out, "--frames", "0:3", "--executor", "sync", "--until", "extent"],
        ["plot", out, "extent", "--frames", "all", "-o", str(picture)],
        ["show", "extent[frame=2]", out],
        ["plan", out, "--set", "extent.quantile=0.1", "--until", "extent", "--json"],
    ]
    printed = run(copy, "-c", ONE_AFTER_ANOTHER, json.dumps(commands))
    assert "float64 (xyz=3) in length" in printed
    assert picture.read_bytes().startswith(b"\x89PNG")
    plan = json.loads(printed[printed.index("\n{") :])
    assert {row["task"] for row in plan["tasks"] if set(row["states"]) - {"fresh"}} == {"extent"}
