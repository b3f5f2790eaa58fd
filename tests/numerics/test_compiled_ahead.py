"""Laws of compiling ahead: the list fits the code, and the process is started where it helps and ends with who started it."""

import fcntl
import importlib
import inspect
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from kinetree.tasks.numerics import compiled_ahead
from kinetree.tasks.numerics.compiled_ahead import SWITCH, compile_all, lines, text_of, type_of
from kinetree.tasks.numerics.input.synth.implicit import Cones

LEXICOGRAPHIC = "kinetree.tasks.numerics.geometry.orientation.lexicographic"
CALL = (
    "import numpy as np, os, sys\n"
    "from kinetree.tasks.numerics import compiled_ahead as ahead\n"
    f"from {LEXICOGRAPHIC.rpartition('.')[0]} import lexicographic\n"
    "os.sched_setaffinity(0, set(sorted(os.sched_getaffinity(0))[: int(sys.argv[1])]))\n"
    "lexicographic(np.zeros((3, 2), np.int32), 1)\n"
    "print(ahead._start.cache_info().currsize)\n"
)
MANY_CORES = len(os.sched_getaffinity(0)) > 1


def seen(*values):
    return [numba.typeof(value) for value in values]


@pytest.mark.parametrize(
    "kind",
    [
        *seen(1.5, 3, True, np.uint64(3), (1, 2, 3), (np.zeros(2, np.uint32), 1.0)),
        *seen(np.zeros((2, 3)), np.zeros((2, 3), order="F"), np.zeros((4, 6))[::2, ::2], np.zeros(3, bool)),
        *seen(np.frombuffer(bytes(16))),
        *seen(np.zeros(2, np.dtype([("target", np.uint32), ("length", np.float32)]))),
        numba.types.BaseTuple.from_types([numba.float64[:, ::1]] * len(Cones._fields), Cones),
    ],
    ids=str,
)
def test_a_type_is_read_as_it_was_written(kind):
    assert type_of(text_of(kind)) == kind


def test_what_has_no_text_is_refused():
    with pytest.raises(TypeError, match="no text for"):
        text_of(numba.typeof("text"))


def test_every_line_names_a_kernel_and_as_many_types_as_it_takes():
    for name, types in lines():
        module, _, function = name.rpartition(".")
        kernel = getattr(importlib.import_module(module), function)
        assert len(inspect.signature(kernel.py_func).parameters) == len(types), name
        assert [text_of(type_of(text)) for text in types] == types


def test_the_list_names_no_kernel_twice_with_the_same_types():
    assert len({str(line) for line in lines()}) == len(lines()) > 50


def test_kernels_that_are_gone_or_take_other_types_are_passed_over():
    fits = (LEXICOGRAPHIC, ["int32[2C]", "int64"])
    gone = [(f"{LEXICOGRAPHIC}_", []), ("kinetree.tasks.numerics.gone.gone", []), (LEXICOGRAPHIC, ["int64"])]
    assert compile_all([*gone, fits, (LEXICOGRAPHIC, ["float999"])], lambda: True) == 1


def test_nothing_more_is_compiled_when_nobody_wants_it():
    wanted = iter([True, False, True])
    fits = (LEXICOGRAPHIC, ["int32[2C]", "int64"])
    assert compile_all([fits] * 3, lambda: next(wanted)) == 1


@pytest.mark.parametrize(
    ("cores", "switch", "started"),
    [pytest.param(2, "1", "1", marks=pytest.mark.skipif(not MANY_CORES, reason="one core")), (1, "1", "0"), (2, "0", "0")],
)
def test_a_kernel_that_is_not_on_disk_has_others_compiled_where_a_core_is_free(tmp_path: Path, cores, switch, started):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), SWITCH: switch}
    command = [sys.executable, "-W", "error", "-c", CALL, str(cores)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == started
    assert done.stderr == ""
    again = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert again.stdout.strip() == "0"  # found on disk


def test_without_its_parent_the_process_compiles_nothing(tmp_path: Path):
    command = [sys.executable, "-m", "kinetree.tasks.numerics.compiled_ahead", "1"]
    subprocess.run(command, env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}, check=True)
    assert not [*tmp_path.rglob("*.nbc")]


def test_one_process_at_a_time_compiles_ahead(tmp_path: Path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    compiled = []
    monkeypatch.setattr(compiled_ahead, "compile_all", lambda which, _: compiled.append(list(which)))
    monkeypatch.setattr(os, "nice", lambda _: None)
    monkeypatch.setenv(SWITCH, "0")
    with (tmp_path / "ahead.lock").open("a") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        compiled_ahead.main(str(os.getppid()))
        assert compiled == []
    compiled_ahead.main(str(os.getppid()))
    assert compiled == [lines()[::-1]]
