"""What a task declares of time and memory: in no key, kept on every executor that can, and said where it cannot."""

import os
import signal
import threading

import numpy as np
import pytest
from distributed import Client, LocalCluster

from kinetree.errors import ClusterError, ConfigError, GraphError
from kinetree.pipeline.running.memory import Needs, measured
from kinetree.pipeline.running.pool import Pool
from kinetree.pipeline.running.sent_parcels import Remote
from kinetree.pipeline.settings.config import Compute
from kinetree.pipeline.storage.store import Store
from kinetree.pipeline.task import task

TOTAL = "@task()\ndef total("
GREEDY = """

class Greedy(Artifact):
    most: int


@task(over="frame", memory=600_000_000)
def greedy(points: Points) -> Greedy:
    flags = Path(os.environ["TOYS_FLAGS"])
    mine = flags / f"held-{os.getpid()}-{points.x[0]}"
    mine.touch()
    threading.Event().wait(0.2)
    most = len(list(flags.glob(f"held-{os.getpid()}-*")))
    mine.unlink()
    return Greedy(most=most)


TASKS = (*TASKS, greedy)
GRAPH = Graph.of(TASKS)
"""


@pytest.fixture
def calm(toys, tmp_path):
    """The artifacts of a run in which nothing was late."""
    store = str(tmp_path / "calm")
    toys.run(store=store)
    toys.clear()
    return toys.artifacts(store=store)


def test_limits_and_retries_are_in_no_key(toys):
    toys.run()
    limited = "SECONDS = 600.0\n\n\n@task(timeout=SECONDS, memory=10**6, retries=3)\ndef total("
    toys.edit(TOTAL, limited)
    assert toys.module.total.timeout == 600.0
    assert toys.run().ran == set()
    toys.edit("@task(timeout=SECONDS, memory=10**6, retries=3)\ndef total(", '@task(over="")\ndef total(')
    assert toys.run().counts == {"total": 1}, "other words of a declaration are in the key"


def test_limits_that_make_no_sense_are_refused(toys):
    for limits in ({"timeout": 0.0}, {"timeout": -1.0}, {"memory": 0}):
        with pytest.raises(GraphError, match=r"expected more than 0 seconds and bytes"):
            task(**limits)(toys.module.total.function)


@pytest.mark.parametrize(("executor", "outcome"), [("threads", "its thread cannot be ended"), ("processes", "is started anew")])
def test_a_node_that_never_comes_back_fails_after_its_retries_and_nothing_else_does(toys, calm, executor, outcome):
    toys.edit(TOTAL, "@task(timeout=0.5)\ndef total(")
    flag = toys.flag("wait-total-210")
    run = toys.run(compute={"executor": executor, "workers": 1})
    flag.unlink()  # a thread goes on
    (failure,) = run.told["failures"]
    assert (failure["node"], failure["error"]) == ("total", "LateNodeError")
    assert failure["message"].startswith(
        "it takes longer than the 0.5 s that its task allows, each of 2 times that it was tried"
    )
    assert outcome in failure["message"]
    assert toys.executions().count("total-210") == 2
    assert {"intervals", "local[interval=2,frame=5]"} <= run.ran


def test_a_node_that_is_late_once_is_tried_again_beside_a_thread_that_hangs(toys, calm):
    toys.edit(TOTAL, "@task(timeout=0.5)\ndef total(")
    toys.flag("stall-total-210")
    run = toys.run(compute={"executor": "threads", "workers": 1})
    (toys.flags / "stalled-total-210").unlink()
    assert run.told["status"] == "done"
    assert toys.artifacts() == calm


def test_a_worker_process_that_does_not_answer_is_ended_when_its_time_is_over(toys, calm):
    toys.edit(TOTAL, "@task(timeout=2.0)\ndef total(")
    toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--executor", "processes", "--workers", "1", "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    toys.until((toys.flags / "waiting-total-210").read_text, "the worker is known", process)
    os.kill(int((toys.flags / "waiting-total-210").read_text()), signal.SIGSTOP)
    (toys.flags / "wait-total-210").unlink()
    _, err = process.communicate(timeout=200)
    assert (process.returncode, err) == (0, "")
    assert toys.executions().count("total-210") == 2
    assert toys.artifacts() == calm


def test_a_node_that_ends_at_the_moment_in_which_it_is_late_is_done(toys, calm, monkeypatch):
    seconds, stalled = Remote.seconds, toys.flags / "stalled-total-210"

    def ended_meanwhile(remote):
        if not seconds(remote) or not stalled.exists():
            return 0.0
        stalled.unlink()
        while remote.future.key in remote.workers.began:
            threading.Event().wait(0.001)
        return 1000.0

    monkeypatch.setattr(Remote, "seconds", ended_meanwhile)
    toys.edit(TOTAL, "@task(timeout=100.0)\ndef total(")
    toys.flag("stall-total-210")
    with LocalCluster(n_workers=1, processes=False, dashboard_address=None) as cluster, Client(cluster) as client:
        assert toys.run(client).told["status"] == "done"
    assert toys.executions().count("total-210") == 1
    assert toys.artifacts() == calm


def test_a_thread_that_has_ended_is_not_given_up():
    pool = Pool(1)
    ended = pool.submit(str, 1)
    assert ended.result() == "1"
    assert ended.seconds() == 0
    assert ended.give_up() is None
    pool.close()


def test_a_late_node_that_has_the_process_to_itself_ends_the_run_in_words(toys):
    toys.edit(TOTAL, "@task(timeout=0.5, threads=2)\ndef total(")
    flag = toys.flag("wait-total-210")
    with pytest.raises(ClusterError, match="total takes longer than the 0.5 s .* cannot be ended; run again on workers"):
        toys.run(compute={"executor": "threads"})
    flag.unlink()


def test_a_node_with_a_limit_travels_alone(toys):
    toys.edit('@task(over="frame")\ndef smooth(', '@task(over="frame", timeout=600.0)\ndef smooth(')
    schedule = toys.pipeline().schedule()
    (first,) = schedule.send(next(schedule.ready()))
    assert first.label.startswith("points")


def test_nodes_that_do_not_fit_together_are_not_on_one_worker_at_once(toys):
    """600 MB each, on workers of 1 GiB with four threads."""
    path = toys.folder / toys.name / "toys.py"
    path.write_text(path.read_text() + GREEDY)
    options = {"n_workers": 2, "threads_per_worker": 4, "processes": True, "dashboard_address": "127.0.0.1:0"}
    with LocalCluster(**options, resources={"memory": 2**30}) as cluster, Client(cluster) as client:
        assert toys.run(client, until=("greedy",)).told["status"] == "done"
    assert [toys.pipeline().artifact("greedy", frame=n).most for n in range(6)] == [1] * 6
    with LocalCluster(**{**options, "n_workers": 1}) as cluster, Client(cluster) as client:
        run = toys.run(client, until=("greedy",), force=("greedy",))
    assert run.told["status"] == "done", "workers that declare nothing are not held back"


def test_our_own_workers_declare_their_memory():
    from kinetree.pipeline.running.own_cluster import local

    assert [Compute(memory=m).memory_bytes for m in ("4GB", "512 MiB", "1.5kB", "7B")] == [4 * 10**9, 2**29, 1500, 7]
    with local(Compute(workers=1, memory="3GiB")) as client:
        client.wait_for_workers(1)
        (worker,) = client.scheduler_info()["workers"].values()
    assert worker["resources"] == {"memory": 3 * 2**30}
    assert worker["memory_limit"] == 3 * 2**30


@pytest.mark.parametrize("memory", ["0GB", "0.5B", "50MB", "260MB", "450MB"])
def test_memory_that_does_not_hold_the_code_of_all_tasks_is_refused(toys, memory):
    """A worker that is over its limit before it computes would be ended and started again for ever."""
    with pytest.raises(ConfigError, match=f"compute.memory {memory}: a worker process needs 600 MB at least"):
        toys.run(compute={"executor": "processes", "workers": 1, "memory": memory})


def test_memory_of_a_node_is_measured_where_it_is_computed_alone(toys):
    with measured() as alone:
        held = np.ones(8_000_000)
    assert 60e6 < alone.own < 100e6 < alone.process
    with measured() as first, measured() as second:
        pass
    assert (first.own, second.own) == (0, 0)
    assert held.size
    toys.run(until=("points",))
    records = list(Store.at(toys.output / "store").records.all())
    assert len(records) == 6
    assert all(0 <= r.own_bytes < r.peak_bytes for r in records)


def test_what_a_node_needs_is_what_its_task_declares_or_the_most_that_was_measured(toys):
    toys.edit(TOTAL, "@task(memory=7)\ndef total(")
    toys.run()
    needs = Needs.of(())
    graph = toys.module.GRAPH
    points, total = graph.task("points"), graph.task("total")
    assert (needs.bytes([points]), needs.bytes([total])) == (0, 7)
    record = next(r for r in Store.at(toys.output / "store").records.all() if r.task == "points")
    for own in (50, 30):
        needs.learn(type(record)(**{**vars(record), "own_bytes": own}))
    assert (needs.bytes([points]), needs.bytes([points, total])) == (50, 50)


def test_a_thread_that_is_given_up_is_replaced():
    pool = Pool(1)
    stop = threading.Event()
    stuck = pool.submit(stop.wait)
    after = pool.submit(str, 1)
    while not stuck.seconds():
        threading.Event().wait(0.01)
    assert after.seconds() == 0
    assert "cannot be ended" in stuck.give_up()
    assert after.result() == "1"
    stop.set()
    pool.close()
