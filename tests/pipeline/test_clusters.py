"""Clusters whose workers come late, come and go, or never come; and those that a configuration names."""

import inspect
import json
import re
import socket
import sys
import threading
import types

import pytest
from distributed import Client, LocalCluster
from distributed.batched import BatchedSend
from distributed.utils import sync
from pipeline.toy_clusters import INSIDE, NONE

from kinetree.errors import ClusterError, ConfigError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.running import clusters
from kinetree.pipeline.running.clusters import cluster_of
from kinetree.pipeline.running.launch import launcher
from kinetree.pipeline.settings.config import Compute


def test_workers_that_come_late_are_waited_for_and_found_by_a_scheduler_file(toys, empty, tmp_path):
    file = tmp_path / "scheduler.json"
    file.write_text(json.dumps({"address": empty.scheduler_address}))
    process = toys.start("run", str(toys.yaml()), "--scheduler-file", str(file), "--quiet")
    toys.until(lambda: (toys.output / "store" / "tmp").exists() and toys.pipeline().runs(), "the run begins", process)
    assert toys.executions() == []
    empty.scale(1)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    assert len(toys.executions()) == 40


def test_without_workers_a_run_gives_up_with_3_and_says_so(toys, empty):
    where = ("--scheduler", empty.scheduler_address, "--wait-workers", "1,0.5")
    done = toys.command("run", str(toys.yaml()), *where, "--quiet")
    assert done.returncode == 3
    assert "--wait-workers 1: 0 workers are there after 0.5 s" in done.stderr
    assert toys.executions() == []


def test_the_window_follows_the_threads_that_live(toys, empty):
    with Client(empty) as client, launcher(Compute(executor="processes"), client) as launch:
        assert launch.window() >= 3
        before = launch.window()
        empty.scale(2)
        toys.until(lambda: launch.window() == 2 * before or launch.window() == 6, "the window grows")


def test_a_cluster_is_named_by_class_and_options(toys, tmp_path):
    options = {**NONE, "processes": False}
    compute = {"cluster": "distributed:LocalCluster", "options": options, "workers": 1}
    assert toys.run(until=("smooth",), compute=compute).told["status"] == "done"
    with pytest.raises(ConfigError, match="compute.cluster nowhere:Cluster: No module named 'nowhere'; install the package"):
        cluster_of(Compute(cluster="nowhere:Cluster"))
    with pytest.raises(ConfigError, match="compute.cluster fractions:Fraction with compute.options cannot be made: .*nonsense"):
        cluster_of(Compute(cluster="fractions:Fraction", options={"nonsense": 1}))


def test_the_preset_for_slurm_asks_the_queue_for_what_it_says():
    jobqueue = pytest.importorskip("dask_jobqueue")
    compute = Pipeline.of({"compute": "slurm"}).config.compute
    quiet = {**compute.options, "scheduler_options": {"dashboard_address": "127.0.0.1:0"}}
    cluster = cluster_of(compute.model_copy(update={"options": quiet}))
    try:
        assert isinstance(cluster, jobqueue.SLURMCluster)
        script = cluster.job_script()
        assert "#SBATCH --cpus-per-task=8" in script
        assert "#SBATCH -t 04:00:00" in script
        assert "--nworkers 8" in script
    finally:
        cluster.close()


def test_the_preset_for_kubernetes_names_options_that_its_cluster_takes():
    operator = pytest.importorskip("dask_kubernetes.operator", reason="dask-kubernetes is not installed")
    compute = Pipeline.of({"compute": "kubernetes"}).config.compute
    assert compute.cluster == "dask_kubernetes.operator:KubeCluster"
    inspect.signature(operator.KubeCluster.__init__).bind(None, **compute.options)


def test_the_preset_for_kubernetes_starts_what_it_names(monkeypatch):
    made = []
    operator = types.ModuleType("dask_kubernetes.operator")
    operator.KubeCluster = lambda **options: made.append(options) or LocalCluster(**INSIDE)
    monkeypatch.setitem(sys.modules, "dask_kubernetes", types.ModuleType("dask_kubernetes"))
    monkeypatch.setitem(sys.modules, "dask_kubernetes.operator", operator)
    compute = Pipeline.of({"compute": "kubernetes"}).config.compute
    with clusters.started(compute) as client:
        assert client.cluster.workers == {}, "none before there is work"
    assert made == [compute.options]
    assert {"name", "image"} <= set(made[0])


@pytest.mark.parametrize("address", ["tcp://a..b:8786", f"tcp://{'a' * 70}:8786"])
def test_a_host_that_no_name_can_be_is_no_address(address):
    with pytest.raises(ConfigError, match="not an address"), clusters.at(Compute(scheduler=address)):
        raise AssertionError


@pytest.fixture
def silent():
    """The address of somebody who answers every call and says nothing."""
    with socket.create_server(("127.0.0.1", 0)) as there:  # whose calls the system answers
        yield f"tcp://127.0.0.1:{there.getsockname()[1]}"


@pytest.mark.parametrize("is_in_a_file", [False, True])
def test_somebody_who_answers_and_says_nothing_is_given_up(silent, tmp_path, monkeypatch, is_in_a_file):
    monkeypatch.setattr(clusters, "CONNECT_SECONDS", 0.5)
    file = tmp_path / "scheduler.json"
    file.write_text(json.dumps({"address": silent}))
    compute = Compute(scheduler_file=str(file)) if is_in_a_file else Compute(scheduler=silent)
    with pytest.raises(ClusterError, match="nobody answers there within"), clusters.at(compute):
        raise AssertionError
    assert not [thread for thread in threading.enumerate() if thread.name == "IO loop"]


def test_a_run_at_somebody_who_says_nothing_ends_with_3(toys, silent):
    done = toys.command("run", str(toys.yaml()), "--scheduler", silent, "--quiet")
    assert done.returncode == 3
    assert f"--scheduler {silent}: nobody answers there within 10 s (TimeoutError)" in done.stderr


@pytest.mark.parametrize(("cluster", "hint"), [("distributed:Nope", False), ("dask_jobqueue_x.slurm:Nope", True)])
def test_only_a_package_that_is_missing_is_to_be_installed(cluster, hint):
    with pytest.raises(ConfigError, match="Nope|No module") as refused:
        clusters.cluster_of(Compute(cluster=cluster))
    assert ("install the package that has it" in str(refused.value)) == hint


def test_an_address_that_is_none_is_the_users_to_mend(toys, tmp_path):
    (tmp_path / "scheduler.json").write_text("{}")
    with pytest.raises(ConfigError, match="--scheduler-file .*: not an address"):
        toys.run(compute={"scheduler_file": str(tmp_path / "scheduler.json")})
    assert clusters.CONNECT_SECONDS > 0


def test_a_report_of_dask_needs_workers(toys, tmp_path):
    with pytest.raises(ConfigError, match="--performance-report: dask reports on workers"):
        toys.run(compute={"executor": "threads", "performance_report": str(tmp_path / "report.html")})


def test_adaptive_workers_come_with_the_work_and_go_with_it(toys):
    compute = {"cluster": "distributed:LocalCluster", "options": INSIDE, "adapt": [0, 2], "workers": 2}
    assert toys.run(until=("total",), compute=compute).told["status"] == "done"
    with clusters.started(Compute(**compute)) as client:
        cluster = client.cluster
        assert len(cluster.workers) == 0, "nothing is to be done"
        assert client.submit(abs, -1).result(timeout=60) == 1
        toys.until(lambda: not cluster.workers, "they go away again")


LATE = """
import os, threading
from pathlib import Path
from distributed import LocalCluster

class Queue(LocalCluster):
    def scale(self, n):
        turn = Path(os.environ["TOYS_FLAGS"]) / "turn"
        def later():
            while self.status.name == "running" and not turn.exists():
                threading.Event().wait(0.01)
            if self.status.name == "running":
                super(Queue, self).scale(n)
        threading.Thread(target=later, daemon=True).start()
"""
"""A queue that starts workers when it is their turn."""


@pytest.fixture
def late(toys):
    """A configuration whose cluster is a queue."""
    (toys.folder / toys.name / "late.py").write_text(LATE)
    return {"cluster": f"{toys.name}.late:Queue", "options": INSIDE, "workers": 1}


def test_a_queue_that_starts_its_workers_late_is_waited_for(toys, late):
    process = toys.start("run", str(toys.yaml(compute=late)), "--quiet")
    toys.until(lambda: (toys.output / "store" / "tmp").exists() and toys.pipeline().runs(), "the run begins", process)
    assert toys.executions() == []
    toys.flag("turn")
    _, err = process.communicate(timeout=100)
    assert (process.returncode, err) == (0, "")
    assert len(toys.executions()) == 40


def test_a_cluster_that_does_not_stop_in_time_is_no_fault_of_the_run(toys, monkeypatch):
    close = LocalCluster.close

    def slow(self, *given, **named):
        close(self, *given, **named)
        raise TimeoutError("join timed out")

    monkeypatch.setattr(LocalCluster, "close", slow)
    compute = {"cluster": "distributed:LocalCluster", "options": INSIDE, "workers": 1}
    assert toys.run(until=("total",), compute=compute).told["status"] == "done"


def test_what_is_sent_while_the_connection_breaks_raises_nothing_that_nobody_can_catch(empty):
    async def sends(client):
        with pytest.MonkeyPatch.context() as broken:  # as a closed one of dask's is, until its client notices
            broken.setattr(client, "scheduler_comm", BatchedSend(interval=1))
            client.scheduler_comm.comm = types.SimpleNamespace(closed=lambda: True)
            client._send_to_scheduler_safe({"op": "heartbeat-client"})
        return client.status

    with clusters.at(Compute(scheduler=empty.scheduler_address)) as client:
        assert sync(client.loop, sends, client) == "running"


def test_a_queue_that_never_starts_a_worker_is_given_up_in_words(toys, late):
    given_up = pytest.raises(
        ClusterError, match=r"no worker for 0\.6 s; .* give a queue more time \(--wait-workers N,SECONDS\)"
    )
    with given_up, launcher(Compute(**late).model_copy(update={"wait_workers": "0,0.6"})) as launch:
        toys.until(launch.look_after, "it is given up")
    done = toys.command("run", str(toys.yaml(compute={**late, "wait_workers": "1,0.5"})), "--quiet")
    assert (done.returncode, toys.executions()) == (3, [])
    assert "--wait-workers 1: 0 workers are there after 0.5 s" in done.stderr


def test_dask_reports_on_a_run(toys, tmp_path):
    report = tmp_path / "report.html"
    compute = {"executor": "processes", "workers": 1, "performance_report": str(report)}
    run = toys.run(until=("total",), compute=compute)
    assert run.told["status"] == "done"
    text = report.read_text()
    # not which: by the clocks of its processes dask may take some for earlier than the report
    assert re.search("number of tasks: [1-9]", text)
    assert "<html" in text
    assert [e["link"].startswith("http://127.0.0.1:") for e in run.heard.events if e["event"] == "dashboard"] == [True]
