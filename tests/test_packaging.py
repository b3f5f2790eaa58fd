"""A wheel built from the sdist, in an environment that has what it requires and nothing else, used from another folder."""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import venv
import zipfile
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent
SHIPPED = (".py", ".pyi", ".yaml", ".js", ".css", ".html", ".jsonl", ".LICENSE")

SCRIPT = """
from kinetree.pipeline import Pipeline
from kinetree.schemas.structure.skeleton import Skeleton

pipeline = Pipeline.of("walk-out")
there = pipeline.inspect()
reveal_type(pipeline.artifact("skeleton"))
reveal_type(there.artifact("skeleton").fps)
reveal_type(there.artifact("kinematic_structure"))
reveal_type(there.artifact(Skeleton))
reveal_type(there.artifact("mesh", frame=3))
reveal_type(there.artifact("stiffness", **{"pass": 1}))
reveal_type(there.artifact("mesh[frame=3]"))
there.artifact("skeletn").positions
"""
"""What a user may write; the last name is misspelt."""
SKELETON, MESH = "kinetree.schemas.structure.skeleton.Skeleton", "kinetree.schemas.input.mesh.Mesh"
STIFFNESS, ANY = "kinetree.schemas.registration.stiffness.Stiffness", "kinetree.schemas.array.Artifact"
REVEALED = [SKELETON, "float | None", SKELETON, SKELETON, MESH, STIFFNESS, ANY]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(out), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "absent from the `packages`" not in done.stdout + done.stderr  # files that a later setuptools would leave out
    return next(out.glob("*.whl"))  # build makes the wheel from the sdist it has just made


def test_wheel_holds_every_module_and_preset_and_nothing_generic(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for folder in ("pipeline", "tasks", "schemas", "configs"):
        for file in (ROOT / folder).rglob("*"):
            if file.suffix in SHIPPED and "__pycache__" not in file.parts:
                assert f"kinetree/{file.relative_to(ROOT)}" in names
    assert {name.split("/")[0] for name in names if ".dist-info" not in name} == {"kinetree"}


@pytest.fixture(scope="module")
def home(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment in which the wheel is installed, with what it requires."""
    home = tmp_path_factory.mktemp("clean")
    venv.create(home)
    (site,) = home.glob("lib/python*/site-packages")
    for name in required(wheel):
        _link(metadata.distribution(name), site)
    pip = [sys.executable, "-m", "pip", "--python", str(home / "bin/python")]
    subprocess.run([*pip, "install", "--quiet", "--no-deps", str(wheel)], check=True, capture_output=True)
    subprocess.run([*pip, "check"], check=True, capture_output=True)
    return home


def test_wheel_works_from_another_folder_with_what_it_requires_alone(home: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    generic = "import importlib.util as u; print([n for n in ('pipeline', 'tasks', 'schemas') if u.find_spec(n)])"
    process = subprocess.run([home / "bin/python", "-c", generic], cwd=elsewhere, capture_output=True, text=True, check=True)
    assert process.stdout.strip() == "[]"
    _write_two_tetrahedra(elsewhere / "two.npz")
    command = [home / "bin/kinetree", "run", "--input", "two.npz", "--output", "out", "--until", "connectivity", "--json"]
    for ran in (4, 0):
        done = subprocess.run(command, cwd=elsewhere, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        counts = json.loads(done.stdout)["nodes"]
        assert counts["ran"] <= ran
        assert (counts["ran"] == 0) == (ran == 0)


def test_a_users_type_checker_knows_the_artifact_of_every_task(home: Path, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(SCRIPT)
    command = [sys.executable, "-m", "mypy", "--strict", "--python-executable", str(home / "bin" / "python"), "script.py"]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False).stdout
    assert re.findall(r'Revealed type is "(.*)"', said) == REVEALED
    (error,) = re.findall(r": error: (.*)", said)
    assert '"Artifact" has no attribute "positions"' in error


def test_same_sources_give_the_same_wheel_to_the_byte(tmp_path: Path) -> None:
    wheels = []
    for n, place in enumerate(("one", "another")):
        copy = tmp_path / place
        ignored = shutil.ignore_patterns(".*", "build", "dist", "*.egg-info", "__pycache__", "tests", "benchmarks")
        shutil.copytree(ROOT, copy, ignore=ignored, copy_function=shutil.copyfile)  # every copy has times of its own
        os.utime(copy / "pipeline" / "graph.py", (10**9, 10**9 + 1000 * n))
        command = [
            sys.executable,
            "-m",
            "build",
            "--wheel",
            "--no-isolation",
            "--outdir",
            str(tmp_path / f"dist-{n}"),
            str(copy),
        ]
        environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000"}
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
        assert done.returncode == 0, done.stdout + done.stderr
        (wheel,) = (tmp_path / f"dist-{n}").glob("*.whl")
        wheels.append(wheel.read_bytes())
    assert wheels[0] == wheels[1]


def test_every_direct_dependency_has_a_floor_and_a_newest_version_that_was_tested() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = {name: rows for name, rows in project["optional-dependencies"].items() if name != "benchmarks"}
    lists = [project["dependencies"], *extras.values()]
    floors = {canonicalize_name(r.name): r.specifier for one in lists for r in map(Requirement, one)}
    rows = [line for line in (ROOT / ".ci" / "tested.txt").read_text().splitlines() if not line.startswith("#")]
    tested = dict(row.split("==") for row in rows)
    unbounded = {name for name, floor in floors.items() if not str(floor)}
    assert unbounded == {"types-pyyaml"}
    assert set(floors) == set(tested)
    assert [name for name, version in tested.items() if version not in floors[name]] == []


def required(wheel: Path) -> set[str]:
    """Names of the distributions that the wheel requires, and that these require."""
    (info,) = (entry for entry in zipfile.Path(zipfile.ZipFile(wheel)).iterdir() if entry.name.endswith(".dist-info"))
    waiting: list[tuple[metadata.Distribution, str]] = [(metadata.PathDistribution(info), "")]
    requirements: set[tuple[str, str]] = set()
    while waiting:
        distribution, extra = waiting.pop()
        for requirement in map(Requirement, distribution.requires or ()):
            if requirement.marker is None or requirement.marker.evaluate({"extra": extra}):
                new = {(requirement.name, wanted) for wanted in {"", *requirement.extras}} - requirements
                waiting += [(metadata.distribution(name), wanted) for name, wanted in new]
                requirements |= new
    return {name for name, _ in requirements}


def _link(distribution: metadata.Distribution, site: Path) -> None:
    """Makes a distribution of this environment a part of another one."""
    for top in {file.parts[0] for file in distribution.files or ()} - {"..", "__pycache__"}:
        if not (site / top).exists():
            (site / top).symlink_to(str(distribution.locate_file(top)))


def _write_two_tetrahedra(path: Path) -> None:
    V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
    F = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int32)
    offsets = {"vertex_offsets": np.array([0, 4, 8]), "face_offsets": np.array([0, 4])}
    np.savez(path, vertices=np.vstack([V, V * 2]), faces=F, fps=25.0, unit="mm", **offsets)
