"""Laws of our own workers while they start: what ends is started again, and a run that can have none ends in words."""

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
import threading
from importlib.machinery import ModuleSpec
from multiprocessing import forkserver

import dask.config
import pytest
from distributed import Client

from kinetree.errors import ClusterError
from kinetree.pipeline.running import own_workers, worker_parent
from kinetree.pipeline.running.launch import ENVIRONMENT, METHOD, TRIM, environment, launcher
from kinetree.pipeline.running.living_workers import LivingWorkers
from kinetree.pipeline.running.own_workers import STARTS, Starts, unguarded_script
from kinetree.pipeline.running.worker_parent import CHOSEN, WorkerParent
from kinetree.pipeline.settings.config import Compute

TWO = Compute(executor="processes", workers=2)
SCRIPT = """
from kinetree.pipeline.inspect import Pipeline
from {name}.toys import GRAPH
Pipeline.of({config!r}, methods={{"toy": GRAPH}}).run()
"""
SOON = own_workers.REPLACE_SECONDS / 2
is_linux = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere workers start as dask starts them")


@pytest.mark.parametrize("method", ["", "spawn"])
def test_a_script_that_lacks_the_guard_ends_in_words(toys, method):
    script = toys.folder / "script.py"
    script.write_text(SCRIPT.format(name=toys.name, config=toys.config(compute={"executor": "processes", "workers": 1})))
    variables = {**os.environ, **({CHOSEN: method} if method else {})}
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=100, env=variables)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith(f"kinetree.errors.ClusterError: no worker process starts: {script} starts")
    assert 'if __name__ == "__main__":' in done.stderr
    assert toys.executions() == []


def test_only_a_script_that_never_asks_for_its_name_is_blamed(tmp_path, monkeypatch):
    main = sys.modules["__main__"]
    script = tmp_path / "script.py"
    monkeypatch.setattr(main, "__file__", str(script), raising=False)
    monkeypatch.setattr(main, "__spec__", None)
    assert unguarded_script() == ""
    script.write_text("run()")
    assert unguarded_script() == str(script)
    script.write_text('"""No __name__."""\nlog(__name__)  # __name__\nrun()')
    assert unguarded_script() == str(script), "a word in a comment is no condition"
    for guard in (
        'if __name__ == "__main__":\n    run()',
        '__name__ == "__main__" and run()',
        'run() if __name__ == "__main__" else None',
        'match __name__:\n    case "__main__":\n        run()',
        'def is_main():\n    return __name__ == "__main__"\nif is_main():\n    run()',
    ):
        script.write_text(guard)
        assert unguarded_script() == "", guard
    monkeypatch.delattr(main, "__file__")
    assert unguarded_script() == ""


@pytest.mark.parametrize("module", ["script", "tool.script", "tool.__main__"])
def test_no_package_that_python_runs_is_blamed(tmp_path, monkeypatch, module):
    main = sys.modules["__main__"]
    script = tmp_path / "script.py"
    script.write_text("run()")
    monkeypatch.setattr(main, "__file__", str(script), raising=False)
    monkeypatch.setattr(main, "__spec__", ModuleSpec(module, None))
    assert unguarded_script() == ("" if module == "tool.__main__" else str(script))


def test_what_ends_their_care_ends_the_run(toys, monkeypatch):
    def broken(*_):
        raise ZeroDivisionError("by nought")

    monkeypatch.setattr(own_workers, "_look_after", broken)
    with pytest.raises(ClusterError, match=r"no longer looked after \(ZeroDivisionError: by nought\)"):
        toys.run(compute={"executor": "processes", "workers": 1})


def test_workers_that_end_while_they_start_end_the_run_after_some_tries(monkeypatch):
    monkeypatch.setattr(own_workers, "unguarded_script", lambda: "")
    workers = LivingWorkers(60, starts=Starts(in_vain=STARTS - 1))
    workers.check()
    workers.starts.in_vain += 1
    with pytest.raises(ClusterError, match="no worker process starts, 3 times tried"):
        workers.check()


@is_linux
def test_kill_9_of_their_parent_before_the_first_is_there_costs_a_moment(toys):
    with WorkerParent() as parent:
        parent.begin(environment(TWO))
        server = forkserver._forkserver._forkserver_pid
        os.kill(server, signal.SIGSTOP)  # so that they wait for it
        with launcher(TWO, None, parent):
            cluster = Client.current().cluster
            toys.until(lambda: any(w.process and w.process.status.name == "starting" for w in cluster._created), "they start")
            threading.Event().wait(0.2)
            os.kill(server, signal.SIGKILL)
            assert Client.current().submit(abs, -1).result(timeout=SOON) == 1


def test_one_that_is_gone_is_replaced_while_others_live(toys):
    with launcher(TWO):
        cluster = Client.current().cluster
        toys.until(lambda: len(cluster.workers) == len(cluster.scheduler.workers) == 2, "both are there")
        gone = next(iter(cluster.workers.values()))
        cluster.sync(gone.close)
        toys.until(lambda: gone not in cluster.workers.values() and len(cluster.scheduler.workers) == 2, "both are there again")


def test_one_that_dask_has_let_go_of_is_replaced_while_others_live(toys):
    """As it does some time after the worker of a nanny that is closed has gone."""
    with launcher(TWO):
        cluster = Client.current().cluster
        toys.until(lambda: len(cluster.workers) == len(cluster.scheduler.workers) == 2, "both are there")
        gone = cluster.workers.pop(next(iter(cluster.workers)))
        cluster.sync(gone.close)
        toys.until(lambda: len(cluster.workers) == len(cluster.scheduler.workers) == 2, "both are there again")


def test_runs_at_the_same_time_have_each_their_own_configuration_and_leave_none():
    before = {key: dask.config.get(key) for key in (METHOD, ENVIRONMENT, "distributed.worker.profile.enabled")}
    trim = os.environ.get(TRIM)
    with contextlib.ExitStack() as first, contextlib.ExitStack() as second:
        first.enter_context(launcher(Compute(executor="processes", workers=1)))
        one = Client.current()
        second.enter_context(launcher(Compute(executor="processes", workers=1, memory="2 GiB")))
        other = Client.current()
        assert one.submit(os.getenv, TRIM).result(timeout=60) == trim
        assert other.submit(os.getenv, TRIM).result(timeout=60) == str(before[ENVIRONMENT][TRIM])
        assert other.submit(dask.config.get, "distributed.worker.profile.enabled").result(timeout=60) is False
        first.close()
        worker = other.submit(os.getpid).result(timeout=60)
        with contextlib.suppress(ProcessLookupError):
            os.kill(worker, signal.SIGKILL)
        assert other.submit(abs, -2).result(timeout=60) == 2
    assert {key: dask.config.get(key) for key in before} == before
    assert os.environ.get(TRIM) == trim


@is_linux
def test_forked_workers_speak_tls_where_it_is_asked_for():
    with launcher(Compute(executor="processes", workers=1, security="temporary")):
        client = Client.current()
        assert client.scheduler.address.startswith("tls://127.0.0.1:")
        assert client.submit(os.getppid).result(timeout=60) == forkserver._forkserver._forkserver_pid


def test_where_python_cannot_fork_from_another_process_workers_start_as_dask_starts_them(monkeypatch):
    monkeypatch.setattr(worker_parent, "get_all_start_methods", lambda: ["spawn"])
    with WorkerParent() as parent, launcher(Compute(executor="processes", workers=1), None, parent):
        assert not parent.is_there
        assert Client.current().submit(os.getppid).result(timeout=60) == os.getpid()


def test_following_over_edited_code_ends_and_runs_neither_code_for_the_other(toys):
    processes = {"executor": "processes", "workers": 1}
    process = toys.start("run", str(toys.yaml(compute=processes)), "--follow", "--quiet")
    toys.until(lambda: (toys.output / "run.json").exists(), "the first run is over", process)
    before = toys.artifacts()
    code = toys.folder / toys.name / "toys.py"
    code.write_text(code.read_text().replace("params.scale * number", "params.scale * number * 2"))
    toys.clear()
    toys.write(70, start=6)
    _, error = process.communicate(timeout=100)
    assert process.returncode == 3
    assert "other code" in error
    assert toys.executions() == []
    toys.forget()
    after = toys.pipeline().plan().nodes
    assert {node.state for node in after if node.node.startswith("points")} == {"stale"}
    toys.run(compute=processes)
    assert toys.artifacts()["points[frame=0]"] != before["points[frame=0]"]


@is_linux
def test_runs_at_the_same_time_share_what_workers_are_forked_from_until_the_last_is_over():
    with WorkerParent() as last:
        with WorkerParent() as first:
            first.begin({})
            last.begin({})
            server = forkserver._forkserver._forkserver_pid
            assert first.is_there
            assert last.is_there
        os.kill(server, 0)
        assert forkserver._forkserver._forkserver_pid == server
    assert forkserver._forkserver._forkserver_pid is None


def test_many_threads_leave_what_was_configured():
    before = dask.config.get(METHOD)

    async def all_at_once() -> None:
        await asyncio.gather(*(asyncio.to_thread(forked) for _ in range(8)))

    def forked() -> None:
        from kinetree.pipeline.running.launch import _forking

        for _ in range(50):
            with _forking():
                assert dask.config.get(METHOD) == "forkserver"

    asyncio.run(all_at_once())
    assert dask.config.get(METHOD) == before
