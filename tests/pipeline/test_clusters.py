"""Clusters whose workers come late, come and go, or never come; and those that a configuration starts itself."""

import concurrent.futures
import gc
import json
import logging
import os
import threading
import time
from pathlib import Path

import dask.config
import pytest
from distributed import Client, LocalCluster
from distributed.comm import CommClosedError

from kinetree.errors import ClusterError, ConfigError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.running import clusters, own_cluster, sent_parcels
from kinetree.pipeline.running.clusters import cluster_of
from kinetree.pipeline.running.launch import ENVIRONMENT, TRIM, launcher
from kinetree.pipeline.running.living_workers import LivingWorkers
from kinetree.pipeline.running.own_cluster import local
from kinetree.pipeline.running.parcels import Demand
from kinetree.pipeline.running.quiet import LOUD, quiet
from kinetree.pipeline.running.sent_parcels import sent
from kinetree.pipeline.settings.config import Compute

NONE = {"n_workers": 0, "threads_per_worker": 1, "processes": True, "dashboard_address": "127.0.0.1:0"}


@pytest.fixture
def empty(toys):
    """A cluster that has no worker yet."""
    with LocalCluster(**NONE) as cluster:
        yield cluster


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


def test_workers_that_all_go_away_end_the_run_in_words():
    workers = LivingWorkers(patience=0.0)
    workers.hear({"a": 1, "b": 2})
    assert (workers.count, workers.threads) == (2, 3)
    workers.check()
    workers._seen = time.monotonic() - 60
    with pytest.raises(ClusterError, match="no worker for 0 s"):
        workers.check()


def test_scheduler_that_stopped_answering_ends_the_run_in_words():
    workers = LivingWorkers(patience=0.0)
    workers.hear({"a": 1})
    workers._answered = workers._seen = time.monotonic() - 60
    with pytest.raises(ClusterError, match="the scheduler has not answered for 0 s"):
        workers.check()


def test_workers_with_less_memory_than_was_asked_for_end_the_run_in_words():
    workers = LivingWorkers(patience=0.0, memory=10**9)
    assert workers.ask("key", 2 * 10**9) == 10**9, "no more than one of them has"
    workers.hear({"small": 1}, {"small": 10**8})
    workers._fitting = time.monotonic() - 60
    with pytest.raises(ClusterError, match=r"no worker for 0 s that declares 1\.0 GB of memory"):
        workers.check()
    workers.forget("key")
    workers.hear({"small": 1}, {"small": 10**8})
    workers.check()


def test_the_window_follows_the_threads_that_live(toys, empty):
    with Client(empty) as client, launcher(Compute(executor="processes"), client) as launch:
        assert launch.window() >= 3
        before = launch.window()
        empty.scale(2)
        toys.until(lambda: launch.window() == 2 * before or launch.window() == 6, "the window grows")


def test_parcels_wait_at_the_scheduler_and_not_at_a_busy_worker(toys, tmp_path):
    end = tmp_path / "end"
    with LocalCluster(**{**NONE, "n_workers": 1, "processes": False}) as cluster, Client(cluster) as client:
        work = ("nowhere", (), None)
        busy = client.submit(held_up, end, key="busy")
        toys.until(lambda: cluster.scheduler.total_occupancy, "the worker is busy")
        parcels = [sent(client, LivingWorkers(60), f"parcel-{n}", Demand(0, None), work) for n in range(3)]
        toys.until(lambda: len(cluster.scheduler.tasks) == 1 + len(parcels), "the scheduler has them")
        waiting = len(cluster.scheduler.queued)
        for future in parcels:
            future.cancel()
        end.touch()
        busy.result(timeout=60)
    assert waiting == 2, "one is at the worker already, so that it does not wait when it is done"


def held_up(end: Path) -> None:
    """Until there is a file."""
    while not end.exists():
        time.sleep(0.01)


def test_a_cluster_is_named_by_class_and_options(toys, tmp_path):
    options = {**NONE, "processes": False}
    compute = {"cluster": "distributed:LocalCluster", "options": options, "workers": 1}
    assert toys.run(until=("smooth",), compute=compute).told["status"] == "done"
    with pytest.raises(ConfigError, match="compute.cluster nowhere:Cluster: No module named 'nowhere'"):
        cluster_of(Compute(cluster="nowhere:Cluster"))
    with pytest.raises(ConfigError, match="compute.options: fractions:Fraction refuses them"):
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


def test_an_address_that_is_none_is_the_users_to_mend(toys, tmp_path):
    (tmp_path / "scheduler.json").write_text("{}")
    with pytest.raises(ConfigError, match="--scheduler-file .*: not an address"):
        toys.run(compute={"scheduler_file": str(tmp_path / "scheduler.json")})
    assert clusters.CONNECT_SECONDS > 0


def test_a_report_of_dask_needs_workers(toys, tmp_path):
    with pytest.raises(ConfigError, match="--performance-report: dask reports on workers"):
        toys.run(compute={"executor": "threads", "performance_report": str(tmp_path / "report.html")})


def test_our_own_workers_are_replaced_where_none_is_left(monkeypatch):
    with local(Compute(workers=1)) as client:
        assert client.submit(abs, -1).result(timeout=60) == 1
        while not client.cluster.workers:  # the cluster lists a worker after the scheduler does
            threading.Event().wait(0.01)
        (nanny,) = client.cluster.workers.values()
        client.cluster.sync(nanny.close)
        assert client.submit(abs, -2).result(timeout=60) == 2


def test_our_own_workers_are_told_before_they_start(monkeypatch):
    """A worker that dies while it is told would take the run with it."""
    there = []
    tell = Client.register_plugin
    monkeypatch.setattr(
        Client, "register_plugin", lambda self, *given: (there.append(len(self.cluster.workers)), tell(self, *given))[1]
    )
    with local(Compute(workers=1)):
        assert there == [0]


INSIDE = {"n_workers": 0, "threads_per_worker": 1, "processes": False, "dashboard_address": "127.0.0.1:0"}
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


@pytest.mark.parametrize(("report", "is_profiled"), [(None, False), ("report.html", True)])
def test_our_own_workers_are_profiled_for_a_report_alone(monkeypatch, tmp_path, report, is_profiled):
    asked = []

    def refuse(*_, **__):
        asked.append(dask.config.get("distributed.worker.profile.enabled"))
        raise ClusterError("enough is known")

    monkeypatch.setattr(own_cluster, "LocalCluster", refuse)
    compute = Compute(executor="processes", performance_report=report and str(tmp_path / report))
    with pytest.raises(ClusterError, match="enough is known"), launcher(compute):
        pass
    assert asked == [is_profiled]
    assert dask.config.get("distributed.worker.profile.enabled")


def test_our_own_workers_do_not_give_back_memory_that_they_need_again():
    """So a run over six frames of 12,000 vertices cleared 1.6 million pages instead of 0.25, in an eighth of its time."""
    assert dask.config.get(ENVIRONMENT)[TRIM]
    with launcher(Compute(executor="processes", workers=1)):
        told = Client.current().submit(os.getenv, TRIM).result(timeout=60)
        assert told == os.environ.get(TRIM)


def test_workers_with_a_limit_of_memory_give_it_back():
    """Dask stops a worker by the memory it holds, also that which is only kept for later."""
    with launcher(Compute(executor="processes", workers=1, memory="2 GiB")):
        told = Client.current().submit(os.getenv, TRIM).result(timeout=60)
    assert told == str(dask.config.get(ENVIRONMENT)[TRIM])


def test_adaptive_workers_come_with_the_work_and_go_with_it(toys):
    compute = {"cluster": "distributed:LocalCluster", "options": INSIDE, "adapt": [0, 2], "workers": 2}
    assert toys.run(until=("total",), compute=compute).told["status"] == "done"
    with clusters.started(Compute(**compute)) as client:
        cluster = client.cluster
        assert len(cluster.workers) == 0, "nothing is to be done"
        assert client.submit(abs, -1).result(timeout=60) == 1
        toys.until(lambda: not cluster.workers, "they go away again")


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


def test_a_queue_that_never_starts_a_worker_is_given_up_in_words(toys, late):
    given_up = pytest.raises(
        ClusterError, match=r"no worker for 0\.6 s; .* give a queue more time \(--wait-workers N,SECONDS\)"
    )
    with given_up, launcher(Compute(**late).model_copy(update={"wait_workers": "0,0.6"})) as launch:
        toys.until(launch.look_after, "it is given up")
    done = toys.command("run", str(toys.yaml(compute={**late, "wait_workers": "1,0.5"})), "--quiet")
    assert (done.returncode, toys.executions()) == (3, [])
    assert "--wait-workers 1: 0 workers are there after 0.5 s" in done.stderr


def fetches(cluster):
    """How often something was fetched from workers."""
    return [event["action"] for _, event in cluster.scheduler.get_events("all")].count("gather")


def test_results_come_along_with_the_word_that_they_are_there(toys):
    with LocalCluster(**{**INSIDE, "n_workers": 1}) as cluster, Client(cluster) as client:
        assert toys.run(client).told["status"] == "done"
        assert fetches(cluster) == 0


def test_results_that_are_too_long_for_an_event_are_fetched(toys, monkeypatch):
    monkeypatch.setattr(sent_parcels, "EVENT_BYTES", 0)
    with LocalCluster(**{**INSIDE, "n_workers": 1}) as cluster, Client(cluster) as client:
        assert toys.run(client).told["status"] == "done"
        assert fetches(cluster) > 0


def test_text_that_is_no_unicode_comes_along_too(toys):
    """Names of files may be, and what is not to be encoded would end the stream to the scheduler."""
    toys.edit('raise ValueError(f"{call} was told to fail")', 'raise ValueError("\\udcff")')
    toys.flag("fail-total-210")
    with LocalCluster(**{**INSIDE, "n_workers": 1}) as cluster, Client(cluster) as client:
        (failure,) = toys.run(client, until=("total",)).told["failures"]
        assert fetches(cluster) == 0
    assert failure["message"] == "\udcff"


def test_nothing_of_a_run_stays_with_a_scheduler_of_somebody_else(toys):
    with LocalCluster(**{**INSIDE, "n_workers": 1}) as cluster, Client(cluster) as client:
        before = set(cluster.scheduler.get_events())
        toys.run(client)
        left = {topic for topic in cluster.scheduler.get_events() if topic not in before}
        assert not [topic for topic in left if not topic.startswith(("tcp", "inproc", "scheduler", client.id))]


def test_nothing_of_a_run_stays_with_a_client_of_somebody_else(toys):
    with LocalCluster(**{**INSIDE, "n_workers": 1}) as cluster, Client(cluster) as client:
        toys.run(client)
        gc.collect()
        assert not [one for one in gc.get_objects() if type(one) is LivingWorkers]


def test_two_runs_of_one_client_at_once_have_their_own_results(toys, tmp_path):
    """The one that subscribes first waits in the middle until the other is over."""
    waits = toys.flag("wait-total-210")
    with LocalCluster(**{**INSIDE, "n_workers": 1, "threads_per_worker": 2}) as cluster, Client(cluster) as client:
        first = concurrent.futures.ThreadPoolExecutor().submit(toys.run, client)
        toys.until((toys.flags / "waiting-total-210").exists, "total begins")
        assert toys.run(client, until=("smooth",), store=str(tmp_path / "other")).told["status"] == "done"
        waits.unlink()
        assert first.result(timeout=60).told["status"] == "done"
        assert fetches(cluster) == 0


def test_a_result_that_cannot_be_fetched_is_no_fault_of_its_node(toys, monkeypatch):
    """A scheduler that is killed while it sends a result."""

    async def closed(*_, **__):
        raise CommClosedError("Stream is closed")

    monkeypatch.setattr(sent_parcels, "EVENT_BYTES", 0)
    with LocalCluster(**{**INSIDE, "n_workers": 1}) as cluster, Client(cluster) as client:
        monkeypatch.setattr(client, "_gather", closed)
        with pytest.raises(ClusterError, match=r"the scheduler is gone \(CommClosedError\); run again"):
            toys.run(client, until=("points",))


def test_what_was_fetched_stays_with_no_worker(toys, empty):
    """A worker that ends would have it computed again elsewhere, for nobody."""
    empty.scale(1)
    gc.disable()
    try:
        with Client(empty) as client:
            toys.run(client)
            toys.until(lambda: not client.run_on_scheduler(lambda dask_scheduler: [*dask_scheduler.tasks]), "nothing is left")
    finally:
        gc.enable()


def test_nothing_is_computed_again_while_workers_end(toys, monkeypatch):
    """Each that ends before the others would leave them what it still holds, such as a failure, which has no record."""
    wanted, end = [], own_cluster._end

    async def noted(cluster, patience):
        wanted.extend(key for key, task in cluster.scheduler.tasks.items() if task.who_wants)
        await end(cluster, patience)

    monkeypatch.setattr(own_cluster, "_end", noted)
    toys.flag("fail-report-6")
    assert toys.run(compute={"executor": "processes", "workers": 2}).heard.nodes("failed") == ["report"]
    assert wanted == []


def test_dask_names_what_runs_by_its_tasks(toys, empty):
    """On the dashboard, in reports and in logs."""
    empty.scale(1)
    with Client(empty) as client:
        toys.run(client, until=("total",))
        names = client.run_on_scheduler(lambda dask_scheduler: sorted(dask_scheduler.task_prefixes))
    assert names == ["points+smooth", "total"]


def test_runs_that_overlap_leave_the_levels_of_loggers_as_the_first_found_them(monkeypatch):
    monkeypatch.setattr(logging.getLogger("distributed.nanny"), "level", logging.WARNING)
    before = {name: logging.getLogger(name).level for name in LOUD}
    first, second = quiet(), quiet()
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert {logging.getLogger(name).level for name in LOUD} == {logging.CRITICAL}
    second.__exit__(None, None, None)
    assert {name: logging.getLogger(name).level for name in LOUD} == before


def test_dask_reports_on_a_run(toys, tmp_path):
    report = tmp_path / "report.html"
    compute = {"executor": "processes", "workers": 1, "performance_report": str(report)}
    run = toys.run(until=("total",), compute=compute)
    assert run.told["status"] == "done"
    text = report.read_text()
    assert "points+smooth" in text
    assert "<html" in text
    assert [e["link"].startswith("http://127.0.0.1:") for e in run.heard.events if e["event"] == "dashboard"] == [True]
