"""Laws of the process that workers are forked from: it loads what they need, is begun for a reason, and ends with the run."""

import os
import sys
from multiprocessing import forkserver
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


def test_without_anything_to_compute_there_is_none():
    with WorkerParent() as parent:
        assert parent.method == "spawn"
        assert forkserver._forkserver._forkserver_pid is None


def test_a_server_of_somebody_else_is_left_alone():
    forkserver.ensure_running()
    server = forkserver._forkserver._forkserver_pid
    try:
        with WorkerParent() as parent:
            parent.begin({})
            assert parent.method == "spawn"
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


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_a_run_on_processes_begins_it_while_it_plans(toys, monkeypatch, executor):
    begun: list[str] = []
    monkeypatch.setattr(WorkerParent, "begin", lambda parent, _: begun.append("parent"))
    monkeypatch.setattr("kinetree.pipeline.inspect.Pipeline._go", lambda *_: begun.append("nodes"))
    toys.pipeline(compute={"executor": executor, "workers": 1}).run()
    assert begun[-1] == "nodes"
    assert ("parent" in begun) == (executor == "processes")
