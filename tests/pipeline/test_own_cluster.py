"""Worker processes that a run starts itself: their environment, their memory and their end."""

import contextlib
import os
import threading

import dask.config
import pytest
from distributed import Client

from kinetree.errors import ClusterError
from kinetree.pipeline.running import own_cluster
from kinetree.pipeline.running.launch import ENVIRONMENT, TRIM, launcher
from kinetree.pipeline.running.own_cluster import local
from kinetree.pipeline.settings.config import Compute


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


@pytest.mark.parametrize("is_stopped", [False, True])
def test_their_client_is_closed_before_they_end(monkeypatch, is_stopped):
    """What it waits for would be computed again by those that end last, such as a failure, which has no record."""
    statuses, end = [], own_cluster._end

    async def noted(cluster, patience):
        statuses.append(client.status)
        await end(cluster, patience)

    monkeypatch.setattr(own_cluster, "_end", noted)
    with pytest.raises(ClusterError) if is_stopped else contextlib.nullcontext(), local(Compute(workers=1)) as client:
        if is_stopped:
            raise ClusterError("no worker")
    assert statuses == ["closed"]
