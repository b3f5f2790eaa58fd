"""Ctrl-C and SIGTERM leave a store from which the next run goes on."""

import contextlib
import json
import os
import signal
from pathlib import Path

import pytest

from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.running import launch
from kinetree.pipeline.running.interrupts import heed, interruptible


def living(group: int) -> list[int]:
    """The processes of a group that still run; one that ended and that nobody asked after does not."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, its_group = status.read_text().rpartition(")")[2].split()[:3]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(its_group) == group and state not in "ZX":
            found.append(int(status.parent.name))
    return found


@pytest.mark.parametrize(
    ("blow", "executor"),
    [
        (signal.SIGINT, "sync"),
        (signal.SIGINT, "threads"),
        (signal.SIGINT, "processes"),
        (signal.SIGTERM, "threads"),
        (signal.SIGTERM, "processes"),
    ],
)
def test_an_interrupted_run_says_so_and_the_next_goes_on(toys, tmp_path, blow, executor):
    store = str(tmp_path / "calm")
    toys.run(store=store)
    toys.clear()
    toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--executor", executor, "--workers", "2", "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    # Ctrl-C reaches every process of the terminal's group, kill only the one it names
    (os.killpg if blow == signal.SIGINT else os.kill)(process.pid, blow)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    toys.until(lambda: not living(process.pid), "no process is left behind")
    assert err.strip() == "toy: interrupted; what is finished is kept, run again to go on"
    told = json.loads((toys.output / "run.json").read_text())
    assert told["status"] == "interrupted"
    assert told["tasks"]["points"]["ran"] == 6
    (toys.flags / "wait-total-210").unlink()
    run = toys.run()
    assert not {"points", "smooth"} & set(run.counts)
    assert run.told["status"] == "done"
    assert toys.artifacts() == toys.artifacts(store=store)


@pytest.mark.parametrize("executor", ["sync", "threads", "processes"])
def test_a_run_that_was_started_deaf_to_ctrl_c_stays_so_and_obeys_sigterm(toys, executor):
    toys.flag("wait-total-210")
    arguments = ("run", str(toys.yaml()), "--executor", executor, "--workers", "2", "--quiet")
    process = toys.start(*arguments, deaf=True)
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    os.killpg(process.pid, signal.SIGINT)
    (toys.flags / "wait-total-210").unlink()
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    assert json.loads((toys.output / "run.json").read_text())["status"] == "done"

    (toys.flags / "waiting-total-210").unlink()
    toys.flag("wait-total-210")
    process = toys.start(*arguments, "--force", "total", deaf=True)
    toys.until((toys.flags / "waiting-total-210").exists, "total begins again", process)
    os.kill(process.pid, signal.SIGTERM)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err.strip() == "toy: interrupted; what is finished is kept, run again to go on"
    toys.until(lambda: not living(process.pid), "no process is left behind")


def test_what_fails_because_a_library_swallowed_an_interrupt_is_no_error_of_ours(toys):
    """As where trimesh takes what is not imported for what is not there, and is asked for it later."""
    swallowed = "import os\n    try: os.kill(os.getpid(), 2)\n    except BaseException: None + 1"
    toys.edit("    from .toys import GRAPH", f"    {swallowed}\n    from .toys import GRAPH", "__main__.py")
    ended = toys.command("run", str(toys.yaml()), "--quiet")
    assert (ended.returncode, ended.stderr.strip()) == (130, "toy: interrupted; what is finished is kept, run again to go on")


def test_an_interrupt_that_a_library_swallows_is_heard_before_the_first_node():
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        for blow in before:
            signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
            heed()
            with interruptible(lambda *_: None, is_apart=True):
                pass
            with contextlib.suppress(BaseException):  # as trimesh imports what may not be there
                os.kill(os.getpid(), blow)
            with pytest.raises(KeyboardInterrupt), interruptible(lambda *_: None, is_apart=False):
                pass
            with interruptible(lambda *_: None, is_apart=False):
                pass  # another run of this process
    finally:
        heed()
        for number, handler in before.items():
            signal.signal(number, handler)


def test_a_signal_that_a_library_passed_over_ends_a_run_before_it_starts_workers(toys, monkeypatch):
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    started = []
    monkeypatch.setattr(launch, "launcher", lambda *_: started.append(True))
    pipeline = toys.pipeline()
    plain = Pipeline.look

    def look(self, *asked):
        with contextlib.suppress(BaseException):
            os.kill(os.getpid(), signal.SIGTERM)
        return plain(self, *asked)

    monkeypatch.setattr(Pipeline, "look", look)
    try:
        heed()
        with pytest.raises(KeyboardInterrupt):
            pipeline.run()
    finally:
        heed()
        for number, handler in before.items():
            signal.signal(number, handler)
    assert started == []
    assert pipeline.runs() == [], "nothing is on record"
