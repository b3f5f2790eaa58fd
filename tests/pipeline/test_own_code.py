"""Laws of the digests of code: what can change a result is part of them, nothing else is."""

import importlib
import sys
from pathlib import Path

import pytest

from kinetree.pipeline.identity import own_code
from kinetree.pipeline.identity.definitions import Code
from kinetree.pipeline.identity.key import digest
from kinetree.pipeline.identity.own_code import code_digest, code_parts
from kinetree.tasks import METHODS

FORMULA = '''"""What it does."""

from dataclasses import dataclass

LIMIT = 3
"""An attribute's docstring."""


@dataclass
class Box:
    """A box."""

    side: float = 1.0
    """Its side."""


def volume(box, power=3, *, scale=2.0):
    """Volume."""
    # why
    return scale * box.side**power if isinstance(box, Box) and box.side < LIMIT else None
'''


def digest_of(text):
    """Digest of the function `volume` of a module, by what it reaches."""
    return digest(sorted((*one, *parts) for one, parts in Code({"formula": text}).reached("formula", "volume").items()))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# why\n", "# because\n"),
        ("    # why\n", ""),
        ('"""What it does."""', '"""Something else."""'),
        ('    """Volume."""\n', ""),
        ('"""An attribute\'s docstring."""', '"""Reworded."""'),
        ('    """Its side."""\n', ""),
        ("\n\n\n", "\n\n\n\n\n"),
        ("scale * box.side**power", "(scale * (box.side ** power))"),
        ("power=3, *, scale=2.0", "power = 3,\n    *,\n    scale = 2.0"),
        ("LIMIT = 3\n", "LIMIT = 0x3\n"),
    ],
)
def test_what_cannot_change_a_result_is_no_part_of_code(old, new):
    assert FORMULA.count(old) >= 1
    assert digest_of(FORMULA.replace(old, new)) == digest_of(FORMULA)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("LIMIT = 3", "LIMIT = 4"),
        ("LIMIT = 3", "LIMIT = 3.0"),
        ("LIMIT = 3", "LIMIT = True"),
        ("LIMIT = 3", "LIMIT = '3'"),
        ("scale * box", "scale + box"),
        ("box.side < LIMIT", "box.side <= LIMIT"),
        ("power=3", "power=2"),
        ("*, scale", "scale"),
        ("scale=2.0", "scale=-2.0"),
        ("else None", "else 0"),
        ("side: float = 1.0", "side: float = 1.5"),
        ("@dataclass\n", ""),
        ("def volume", "def area"),
        ("return scale * box.side**power if", "return box.side**power * scale if"),
        ("LIMIT = 3\n", "LIMIT = None\n"),
    ],
)
def test_what_can_change_a_result_is_part_of_code(old, new):
    assert FORMULA.count(old) == 1
    assert digest_of(FORMULA.replace(old, new)) != digest_of(FORMULA)


def test_returning_none_in_words_or_not_at_all_are_distinct_from_other_returns():
    bodies = ["return", "return None", "return 0", "return ''", "return ...", "pass"]
    found = {digest_of(f"def volume():\n    {body}\n") for body in bodies}
    assert len(found) == len(bodies)


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Writes modules of an installed package that counts as code, and names it."""
    monkeypatch.syspath_prepend(str(tmp_path))
    name = f"coded_{tmp_path.name.replace('-', '_')}"

    def write(**files):
        for file, text in {"__init__": "", **files}.items():
            path = tmp_path / name / f"{file.replace('__in__', '/')}.py"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text.replace("PACKAGE", name))
        importlib.invalidate_caches()
        own_code.forget_code()
        return name

    yield write
    own_code.forget_code()


def test_code_of_somebody_elses_package_is_read_without_importing_it(package):
    name = package(task="from .sub.deep import f\ndef t(): return f()", sub__in____init__="", sub__in__deep="def f(): return 1")
    before = code_digest(f"{name}.task", "t")
    assert set(code_parts(f"{name}.task", "t")) == {f"{name}.task", f"{name}.sub.deep"}
    package(sub__in__deep="def f(): return 2")
    assert code_digest(f"{name}.task", "t") != before
    assert not [module for module in sys.modules if module.startswith(name)]


def test_parts_of_code_name_every_definition_by_module(package):
    text = "import math\nfrom .other import g\nA = 1\nB = 2\ndef t(): return g(A) + math.pi\n"
    name = package(task=text, other="def g(x): return x\n")
    parts = code_parts(f"{name}.task", "t")
    names = {module: [part.partition(":")[0] for part in told.split()] for module, told in parts.items()}
    assert names == {f"{name}.task": ["(imports)", "A", "t"], f"{name}.other": ["g"]}


def test_code_is_remembered_until_it_is_to_be_forgotten(package):
    name = package(task="def t(): return 1\n")
    before = code_digest(f"{name}.task", "t")
    next(p for p in map(Path, sys.path) if (p / name).is_dir()).joinpath(name, "task.py").write_text("def t(): return 2\n")
    assert code_digest(f"{name}.task", "t") == before
    own_code.forget_code()
    assert code_digest(f"{name}.task", "t") != before


def test_tasks_of_kinetree_reach_their_numerics_and_schemas_and_never_the_loom():
    parts = code_parts("kinetree.tasks.input.mesh", "mesh")
    assert {
        f"kinetree.{m}" for m in ("tasks.input.mesh", "tasks.numerics.input.mesh", "schemas.input.mesh", "schemas.array")
    } <= set(parts)
    assert not [m for m in parts if m.startswith(("kinetree.pipeline", "kinetree.errors"))]


def test_no_task_of_kinetree_reaches_the_table_of_all_tasks():
    for task in {t.name: t for graph in METHODS.values() for t in graph.tasks}.values():
        assert "kinetree.tasks" not in code_parts(task.module, task.name), task.name


def test_no_task_before_the_structure_depends_on_its_code():
    """Not even by a statement of a module that hands a common type on, which might change what all others reach."""
    shelves = ("kinetree.tasks.input.", "kinetree.tasks.topology.", "kinetree.tasks.registration.")
    tasks = [task for task in METHODS["mesoscopic"].tasks if task.module.startswith(shelves)]
    assert len(tasks) > 20
    for task in tasks:
        of_structure = [part for part in code_parts(task.module, task.name) if part.startswith(STRUCTURE)]
        assert not of_structure, task.name


STRUCTURE = "kinetree.tasks.numerics.structure."


def test_code_without_source_is_refused_by_name():
    with pytest.raises(ModuleNotFoundError, match=r"no source for module 'kinetree\.tasks\.nothing'"):
        code_digest("kinetree.tasks.nothing", "nothing")


# Pinned with Python 3.11. A change here changes every key there is: say so in the changelog.
TASK = '''"""What it does."""
from math import pi
RADIUS = 2
def task(r: float = RADIUS) -> float:
    """Area."""
    return pi * r**2
'''


def test_digest_of_code_never_changes(monkeypatch):
    monkeypatch.setattr(own_code, "_code", lambda roots: Code({"pinned.module": TASK}))
    assert code_digest("pinned.module", "task") == "35576bc8fe3fa1a3db96c3e49ecc81c9516dd60c"
    assert code_parts("pinned.module", "task") == {"pinned.module": "(imports):168e9c RADIUS:fdf5d1 task:a7da86"}
