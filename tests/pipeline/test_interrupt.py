"""Ctrl-C and SIGTERM leave a store from which the next run goes on."""

import json
import os
import signal

import pytest


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
    assert err.strip() == "kinetree: interrupted; what is finished is kept, run again to go on"
    told = json.loads((toys.output / "run.json").read_text())
    assert told["status"] == "interrupted"
    assert told["tasks"]["points"]["ran"] == 6
    (toys.flags / "wait-total-210").unlink()
    run = toys.run()
    assert not {"points", "smooth"} & set(run.counts)
    assert run.told["status"] == "done"
    assert toys.artifacts() == toys.artifacts(store=store)
