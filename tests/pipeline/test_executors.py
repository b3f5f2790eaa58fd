"""Wherever nodes are computed the results are the same bytes; workers may die, stale ones are refused."""

import contextlib
import gc
import json
import os
import re
import signal
import socket
import subprocess
import sys

import pytest
from distributed import Client, LocalCluster

from kinetree.errors import ConfigError, StaleWorkerError
from kinetree.pipeline.running.execute import compute
from kinetree.pipeline.running.parcels import steps_of


@pytest.fixture
def cluster(toys):
    """Two worker processes that know the toy package, as somebody else's dask would."""
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as found:
        yield found


def test_results_are_the_same_bytes_wherever_they_are_computed(toys, cluster, tmp_path):
    def digests(name, client=None, **compute):
        toys.clear()
        run = toys.run(client, store=str(tmp_path / name), compute={"executor": "sync", **compute})
        assert run.told["status"] == "done"
        assert len(toys.executions()) == 40
        return toys.artifacts(store=str(tmp_path / name)), sorted(toys.executions())

    expected = digests("sync")
    assert digests("thread", executor="threads", workers=1) == expected
    assert digests("threads", executor="threads", workers=4) == expected
    assert digests("address", scheduler=cluster.scheduler_address) == expected
    with Client(cluster) as client:
        assert digests("client", client) == expected


def test_a_killed_worker_costs_its_node_another_try_and_nothing_else(toys, tmp_path):
    """Worker processes of the run's own, one of which kills itself with SIGKILL in the middle of a node."""
    toys.run(store=str(tmp_path / "calm"))
    toys.clear()
    toys.flag("die-total-210")
    toys.flag("fail-report-6")
    run = toys.run(compute={"executor": "processes", "workers": 2})
    assert run.heard.nodes("failed") == ["report"]
    assert toys.executions().count("total-210") == 2
    assert toys.executions().count("report-6") == 1, "an error of the task's own is no reason to try again"
    calm = toys.artifacts(store=str(tmp_path / "calm"))
    assert {**toys.artifacts(), "report": calm["report"]} == calm


def test_a_failure_that_has_arrived_is_not_computed_again_when_its_worker_dies_later(toys):
    """The chain is sent when the failure has arrived, since the one worker has computed the chain's order after it."""
    toys.flag("fail-intervals-6")
    toys.flag("die-track-25")
    gc.disable()  # what is in a ring goes when garbage is collected, which may be soon
    try:
        run = toys.run(compute={"executor": "processes", "workers": 1}, until=("track", "intervals"))
    finally:
        gc.enable()
    assert run.heard.nodes("failed") == ["intervals"]
    assert toys.executions().count("track-25") == 2
    assert toys.executions().count("intervals-6") == 1


def test_a_node_that_kills_every_worker_fails_alone(toys):
    """Frames go on being read while the workers that take one node die under it, until nobody gets it any more."""
    toys.flag("slay-total-210")
    run = toys.run(compute={"executor": "processes", "workers": 1}, until=("total", "intervals"))
    (failure,) = run.told["failures"]
    assert (failure["node"], failure["error"]) == ("total", "LostWorkerError")
    assert failure["message"].startswith("the worker was lost")
    # a result that died with its worker is found in the store when the node is tried again
    assert "intervals" in {*run.ran, *run.heard.nodes("fresh")}
    assert toys.executions().count("total-210") > 1


def test_a_client_handed_in_twice_does_not_take_one_run_for_the_other(toys, cluster, tmp_path):
    with Client(cluster) as client:
        assert len(toys.run(client, until=("smooth",)).ran) == 12
        assert len(toys.run(client, until=("smooth",), store=str(tmp_path / "other")).ran) == 12
        assert toys.run(client, until=("smooth",), force=("smooth",)).ran == {f"smooth[frame={n}]" for n in range(6)}
        toys.edit("return Smooth(value=rough(", "return Smooth(value=1.0 + rough(")
        told = toys.command("run", str(toys.yaml()), "--scheduler", cluster.scheduler_address, "--quiet")
        assert told.returncode == 3
        assert "planned with other code" in told.stderr
        assert "restart the workers" in told.stderr
        assert "Traceback" not in told.stderr


def parcel(toys, **blocks):
    """The first parcel of a run, as it would travel."""
    schedule = toys.pipeline(**blocks).schedule()
    return schedule, steps_of(schedule, schedule.send(next(schedule.ready())))


def test_a_worker_with_other_code_refuses(toys):
    schedule, steps = parcel(toys)
    schedule.store.create()
    toys.edit("return Points(x=params.scale", "return Points(x=2.0 * params.scale")
    toys.module  # noqa: B018 - a worker that has loaded the new code
    first, second = compute(schedule.store.url, steps)
    assert (first.status, first.error) == ("refused", StaleWorkerError.__name__)
    assert "points[frame=0]: planned with other code" in first.message
    assert second.status == "undone"
    assert toys.executions() == []


def test_a_worker_that_loaded_old_code_does_not_pass_it_off_as_the_new(toys):
    schedule, steps = parcel(toys)
    schedule.store.create()
    module = toys.module
    path = toys.folder / toys.name / "toys.py"
    path.write_text(path.read_text().replace("return Smooth(value=rough(", "return Smooth(value=1.0 + rough("))
    # edited below a process that lives on: what it plans and computes is still the old code
    assert {r.status for r in compute(schedule.store.url, steps)} == {"ran"}
    assert toys.run(until=("smooth",)).told["nodes"]["failed"] == 0
    old = toys.artifacts()["smooth[frame=0]"]
    assert toys.module is module
    toys.forget()
    plan = toys.pipeline().plan()
    assert [str(r) for r in plan["smooth[frame=0]"].reasons] == [f"code: {toys.name}.toys:smooth"]
    toys.run(until=("smooth",))
    assert toys.artifacts()["smooth[frame=0]"] != old


def test_a_worker_derives_the_planners_keys(toys, tmp_path):
    toys.run(compute={"executor": "processes", "workers": 1}, until=("smooth",))
    assert toys.run(until=("smooth",)).ran == set()


def test_a_scheduler_that_goes_away_ends_the_run_in_words(toys):
    toys.flag("wait-total-210")
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as cluster:
        process = toys.start("run", str(toys.yaml()), "--scheduler", cluster.scheduler_address, "--quiet")
        toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
        assert [run["status"] for run in toys.pipeline().runs()] == ["running"]
    _, err = process.communicate(timeout=60)
    assert process.returncode == 3
    assert err.strip() == "toy: the scheduler lost the work; was it stopped or started anew? Run again to go on"
    (toys.flags / "wait-total-210").unlink()
    assert not {"points", "smooth"} & set(toys.run().counts)


def test_a_scheduler_that_is_started_anew_at_its_address_ends_the_run_and_serves_the_next(toys, tmp_path):
    file, waits = tmp_path / "scheduler.json", toys.flag("wait-total-210")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    where = ("--host", "127.0.0.1", "--port", port, "--no-dashboard", "--scheduler-file", str(file))
    with begun("scheduler", *where) as first, begun("worker", f"tcp://127.0.0.1:{port}", "--no-dashboard"):
        process = toys.start("run", str(toys.yaml()), "--scheduler-file", str(file), "--quiet")
        toys.until((toys.flags / "waiting-total-210").exists, "total begins", process, first)
        first.kill()
        first.wait()
        with begun("scheduler", *where), begun("worker", f"tcp://127.0.0.1:{port}", "--no-dashboard"):
            _, err = process.communicate(timeout=60)
            assert process.returncode == 3
            assert err.strip() == "toy: the scheduler lost the work; was it stopped or started anew? Run again to go on"
            waits.unlink()
            toys.clear()
            again = toys.command("run", str(toys.yaml()), "--scheduler-file", str(file), "--wait-workers", "1,60", "--quiet")
    assert (again.returncode, again.stderr) == (0, "")
    assert not [name for name in toys.executions() if name.startswith(("points", "smooth"))]


@contextlib.contextmanager
def begun(command, *options):
    """A command of dask's own, as somebody runs it, ended with the block."""
    module = f"distributed.cli.dask_{command}"
    process = subprocess.Popen(
        [sys.executable, "-m", module, *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@pytest.mark.parametrize("client", ["tcp://host:8786", 3, Client])
def test_what_is_no_client_is_refused_in_words_also_where_nothing_is_to_be_computed(toys, client):
    words = f"expected a distributed.Client to run on, got {client!r}"
    for _ in ("first", "nothing to do"):
        with pytest.raises(ConfigError, match=f"^{re.escape(words)}"):
            toys.pipeline().run(client)
        toys.run()


def test_a_scheduler_nobody_runs_is_refused_in_words(toys, monkeypatch):
    from kinetree.errors import ClusterError
    from kinetree.pipeline.running import clusters

    monkeypatch.setattr(clusters, "CONNECT_SECONDS", 0.2)
    with pytest.raises(ClusterError, match="nobody answers there"):
        toys.run(compute={"scheduler": "tcp://127.0.0.1:9"})
    assert json.loads((toys.output / "run.json").read_text())["status"] == "stopped"
