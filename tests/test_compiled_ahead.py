"""Laws of compiling ahead: a process beside the run where that helps, which ends with the run."""

import contextlib
import fcntl
import os
import subprocess
from pathlib import Path

import pytest

from kinetree.pipeline.identity.own_code import code_parts
from kinetree.pipeline.inspect import Pipeline
from kinetree.tasks import compiled_ahead
from kinetree.tasks.compiled_ahead import SWITCH, compiling_ahead, main
from kinetree.tasks.methods import METHODS
from kinetree.tasks.numerics import kernel_list


@pytest.fixture
def processes(tmp_path: Path, monkeypatch):
    """The processes that are started, on a machine of two cores with no kernel on disk."""
    started = []

    def popen(*arguments, **options):
        started.append(subprocess_popen(*arguments, **options))
        return started[-1]

    subprocess_popen = subprocess.Popen
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))
    monkeypatch.setenv(SWITCH, "1")
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})
    monkeypatch.setattr(compiled_ahead.subprocess, "Popen", popen)
    return started


@contextlib.contextmanager
def nothing_started(processes):
    before = len(processes)
    yield
    assert len(processes) == before


def test_the_process_is_there_inside_the_block_and_ends_with_it(processes):
    with compiling_ahead():
        (process,) = processes
        assert process.poll() is None
    assert process.returncode is not None


def test_the_process_ends_with_a_run_that_fails(processes):
    with pytest.raises(ValueError, match="failed"), compiling_ahead():
        raise ValueError("failed")
    assert processes[0].returncode is not None


def test_no_process_on_one_core_nor_where_it_is_switched_off_nor_without_a_folder(processes, tmp_path: Path, monkeypatch):
    with monkeypatch.context() as one, nothing_started(processes):
        one.setattr(os, "sched_getaffinity", lambda _: {0})
        with compiling_ahead():
            pass
    with monkeypatch.context() as off, nothing_started(processes):
        off.setenv(SWITCH, "0")
        with compiling_ahead():
            pass
    (tmp_path / "file").touch()
    with monkeypatch.context() as bare, nothing_started(processes):
        bare.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file" / "kernels"))
        with compiling_ahead():
            pass


def test_nothing_is_started_once_all_is_compiled(processes, tmp_path: Path, monkeypatch, capsys):
    monkeypatch.setattr(kernel_list, "lines", lambda: [("numerics.gone", [])])
    main()
    assert capsys.readouterr().out == f"0 of 1 kernels are ready in {tmp_path / 'kernels'}\n"
    with nothing_started(processes), compiling_ahead():
        pass


def test_one_process_at_a_time_compiles_from_the_last_to_the_first(processes, tmp_path: Path, monkeypatch):
    compiled = []
    monkeypatch.setattr(kernel_list, "compile_all", lambda which, _: compiled.append(list(which)))
    monkeypatch.setattr(os, "nice", lambda _: None)
    (tmp_path / "kernels").mkdir()
    with (tmp_path / "kernels" / "ahead.lock").open("a") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        main(str(os.getppid()))
        assert compiled == []
    main(str(os.getppid()))
    assert compiled == [kernel_list.lines()[::-1]]


def test_without_its_parent_nothing_is_compiled(tmp_path: Path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(os, "nice", lambda _: None)
    main("1")
    assert not [*tmp_path.rglob("*.nbc")]
    assert not [*tmp_path.glob("ahead-*")]


def test_no_key_knows_of_the_process():
    for task in METHODS["mesoscopic"].tasks:
        modules = code_parts(task.module, task.name)
        assert not {"kinetree.tasks.compiled_ahead", "kinetree.tasks.numerics.kernel_list"} & set(modules), task.name


def test_a_run_has_it_beside_and_a_run_with_nothing_to_do_has_not(processes, tmp_path: Path):
    pipeline = Pipeline.of({"source": {"synth": {"frames": 2, "vertices": 300}}, "output": str(tmp_path / "out")})
    pipeline.run(until=["sequence"])
    assert len(processes) == 1
    pipeline.run(until=["sequence"])
    assert len(processes) == 1
