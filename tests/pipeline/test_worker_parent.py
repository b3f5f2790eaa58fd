"""Laws of the process that workers are forked from: it loads what they need, is begun for a reason, and ends with the run."""

import contextlib
import os
import signal
import subprocess
import sys
from multiprocessing import forkserver, get_context
from pathlib import Path

import pytest
from distributed import Client

from kinetree.pipeline.running.launch import ENVIRONMENT, METHOD, VARIABLES, environment, launcher
from kinetree.pipeline.running.worker_parent import WorkerParent
from kinetree.pipeline.settings.config import Compute
from kinetree.pipeline.storage.files import Files

ONE = Compute(executor="processes", workers=1)
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere workers start as dask starts them")


def test_workers_are_forked_and_have_what_the_product_has_loaded():
    with WorkerParent("colorsys:rgb_to_hls") as parent:  # it fails, for want of colours; what it imported is there
        parent.begin(environment(ONE))
        server = forkserver._forkserver._forkserver_pid
        with launcher(ONE, None, parent):
            client = Client.current()
            assert client.submit(os.getppid).result(timeout=60) == server
            loaded = client.submit(eval, "set(__import__('sys').modules)").result(timeout=60)
            assert {"colorsys", "kinetree.pipeline.running.execute"} <= loaded
    with pytest.raises(ProcessLookupError):
        os.kill(server, 0)


def test_what_an_interrupted_run_leaves_is_removed_without_a_warning_after_the_prompt():
    """A semaphore that is left is what Python warns of; the process that removes it is told not to."""
    left = """
import os, multiprocessing
from kinetree.pipeline.running.worker_parent import WorkerParent
with WorkerParent() as parent:
    parent.begin({})
    left = multiprocessing.get_context("forkserver").Semaphore()
    os._exit(130)
"""
    ended = subprocess.run([sys.executable, "-c", left], capture_output=True, text=True, check=False, timeout=60)
    assert (ended.returncode, ended.stderr) == (130, "")


def test_without_anything_to_compute_there_is_none():
    with WorkerParent() as parent:
        assert not parent.is_there
        assert forkserver._forkserver._forkserver_pid is None


def test_a_server_of_somebody_else_is_left_alone():
    forkserver.ensure_running()
    server = forkserver._forkserver._forkserver_pid
    try:
        with WorkerParent() as parent:
            parent.begin({})
            assert not parent.is_there
        os.kill(server, 0)
    finally:
        forkserver._forkserver._stop()


def test_the_environment_of_this_process_stays_as_it_was(monkeypatch):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    assert environment(ONE)["OPENBLAS_NUM_THREADS"] == "3"
    before = dict(os.environ)
    with WorkerParent() as parent:
        parent.begin(environment(ONE))
        assert dict(os.environ) == before
        assert Path(f"/proc/{forkserver._forkserver._forkserver_pid}").exists()


def test_processes_are_begun_with_what_dask_would_set():
    import dask.config
    import distributed

    assert distributed
    assert dask.config.get(ENVIRONMENT) == VARIABLES
    assert METHOD.removeprefix("distributed.worker.") in dask.config.get("distributed.worker")


def test_it_is_begun_before_a_file_is_read_for_the_first_time(toys, tmp_path):
    path = tmp_path / "new"
    path.write_text("text")
    os.utime(path, (1e9, 1e9))
    told: list[str] = []
    files = Files.of(toys.pipeline().store, unknown=lambda: told.append("unknown"))
    for _ in range(2):
        files.parts(path, "kind", lambda _: (told.append("read"), ["digest"])[1])
    assert told[:2] == ["unknown", "read"]


def test_nothing_is_imported_from_the_folder_that_the_user_is_in(tmp_path, monkeypatch):
    for name in ("distributed", "colorsys", "trimesh"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit")
    monkeypatch.chdir(tmp_path)
    with WorkerParent("colorsys:rgb_to_hls") as parent, launcher(ONE, None, parent):
        file = Client.current().submit(eval, "__import__('sys').modules['colorsys'].__file__").result(timeout=60)
        assert not Path(file).is_relative_to(tmp_path)
        assert "PYTHONSAFEPATH" not in Client.current().submit(eval, "dict(__import__('os').environ)").result(timeout=60)


def test_a_user_who_says_how_dask_starts_processes_has_none(monkeypatch):
    monkeypatch.setenv("DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD", "spawn")
    with WorkerParent() as parent:
        parent.begin({})
        assert not parent.is_there


def test_a_program_that_ignores_what_becomes_of_its_children_sees_the_end(monkeypatch):
    before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    try:
        with WorkerParent() as parent:
            parent.begin({})
            assert parent.is_there
        assert forkserver._forkserver._forkserver_pid is None
    finally:
        signal.signal(signal.SIGCHLD, before)


def test_where_the_system_has_no_socket_for_it_workers_start_as_dask_starts_them(monkeypatch):
    def refused():
        raise OSError("AF_UNIX path too long")

    monkeypatch.setattr(forkserver, "ensure_running", refused)
    with WorkerParent() as parent, launcher(ONE, None, parent):
        assert not parent.is_there
        assert Client.current().submit(int, "3").result(timeout=60) == 3


@pytest.mark.parametrize("error", [OSError, RuntimeError])
def test_where_it_does_not_start_what_the_program_has_it_load_stays(monkeypatch, error):
    def refused():
        raise error

    monkeypatch.setattr(forkserver._forkserver, "_preload_modules", ["colorsys"])
    monkeypatch.setattr(forkserver, "ensure_running", refused)
    with contextlib.suppress(RuntimeError), WorkerParent() as parent:
        parent.begin({})
    assert not parent.is_there
    assert forkserver._forkserver._preload_modules == ["colorsys"]


def test_it_ends_soon_while_others_have_children_of_it_and_leaves_what_they_had_set():
    before = forkserver._forkserver._preload_modules
    with WorkerParent() as parent:
        parent.begin({})
        server = forkserver._forkserver._forkserver_pid
        with get_context("forkserver").Pool(1) as pool:
            assert pool.apply(int, ("3",)) == 3
            began = forkserver._forkserver._forkserver_address
            parent.__exit__(None, None, None)
            assert forkserver._forkserver._preload_modules == before
            assert pool.apply(int, ("4",)) == 4
            assert forkserver._forkserver._forkserver_pid is None
    os.waitpid(server, 0)  # it has gone with the last of them
    assert not Path(began).exists()


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_a_run_on_processes_begins_it_while_it_plans(toys, monkeypatch, executor):
    begun: list[str] = []
    monkeypatch.setattr(WorkerParent, "begin", lambda parent, _: begun.append("parent"))
    monkeypatch.setattr("kinetree.pipeline.inspect.Pipeline._go", lambda *_: begun.append("nodes"))
    toys.pipeline(compute={"executor": executor, "workers": 1}).run()
    assert begun[-1] == "nodes"
    assert ("parent" in begun) == (executor == "processes")
