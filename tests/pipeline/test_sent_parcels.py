"""Parcels wait at the scheduler, and their results come as events or are fetched."""

import concurrent.futures
import gc
import signal
import time
from pathlib import Path

import pytest
from distributed import Client, LocalCluster
from distributed.comm import CommClosedError
from pipeline.toy_clusters import INSIDE, NONE

from kinetree.errors import ClusterError
from kinetree.pipeline.running import sent_parcels
from kinetree.pipeline.running.living_workers import LivingWorkers
from kinetree.pipeline.running.parcels import Demand
from kinetree.pipeline.running.sent_parcels import sent


def fetches(cluster):
    """How often something was fetched from workers."""
    return [event["action"] for _, event in cluster.scheduler.get_events("all")].count("gather")


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


def test_what_an_interrupted_run_leaves_to_be_computed_leaves_nothing_with_the_scheduler(toys, empty):
    empty.scale(1)
    waits = toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--scheduler", empty.scheduler_address, "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 130
    waits.unlink()
    with Client(empty) as client:
        assert client.submit(abs, -1).result(timeout=60) == 1, "the worker, which has one thread, is done with it"
        topics = client.run_on_scheduler(lambda dask_scheduler: [*dask_scheduler.get_events()])
    assert toys.artifacts()["total"], "what it had begun is stored"
    assert not [topic for topic in topics if topic.startswith("parcels-")]


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


def test_results_that_have_arrived_stay_with_no_worker(toys, empty):
    """A worker that ends would have them computed again elsewhere, for nobody; so too a failure, which has no record."""
    empty.scale(1)
    toys.flag("fail-report-6")
    gc.disable()
    try:
        with Client(empty) as client:
            assert toys.run(client).heard.nodes("failed") == ["report"]
            toys.until(lambda: not client.run_on_scheduler(lambda dask_scheduler: [*dask_scheduler.tasks]), "nothing is left")
    finally:
        gc.enable()


def test_dask_names_what_runs_by_its_tasks(toys, empty):
    """On the dashboard, in reports and in logs."""
    empty.scale(1)
    with Client(empty) as client:
        toys.run(client, until=("total",))
        names = client.run_on_scheduler(lambda dask_scheduler: sorted(dask_scheduler.task_prefixes))
    assert names == ["points+smooth", "total"]
