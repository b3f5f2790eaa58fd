"""Inside a task libraries use one thread, or what the task declares, whatever computes it; afterwards what they used before."""

import json
import os
import subprocess
import sys
import threading

import numpy as np
import pytest
from threadpoolctl import ThreadpoolController

from kinetree.pipeline.running.threads import blas, limited, simd

MATRIX = np.random.default_rng(0).normal(size=(4, 4))


def used(kind: str = "blas") -> set[int]:
    """Threads of each library of this process, of OpenMP for the thread that asks."""
    return {library["num_threads"] for library in ThreadpoolController().info() if library["user_api"] == kind}


@pytest.fixture(autouse=True)
def two():
    """A process whose libraries use two threads, as by default on two cores."""
    MATRIX @ MATRIX
    limits = ThreadpoolController().limit(limits=2)
    yield
    limits.restore_original_limits()


def test_inside_the_block_one_thread_afterwards_what_was_before(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    with limited():
        assert used() == {1}
        assert used("openmp") <= {1}
        assert (os.environ["OMP_NUM_THREADS"], os.environ["MKL_NUM_THREADS"]) == ("1", "1")
    assert used() == {2}
    assert (os.environ["OMP_NUM_THREADS"], os.environ.get("MKL_NUM_THREADS")) == ("7", None)


def test_a_task_that_ends_first_takes_nothing_from_the_others():
    inside, end = threading.Event(), threading.Event()

    def other():
        with limited():
            inside.set()
            end.wait()

    task = threading.Thread(target=other)
    task.start()
    inside.wait()
    with limited():
        assert used("openmp") <= {1}
    assert used() == {1}
    end.set()
    task.join()
    assert used() == {2}


def test_a_task_with_more_threads_has_its_process_to_itself():
    seen: list[set[int]] = []

    def wide():
        with limited(2):
            seen.append(used())

    with limited():
        task = threading.Thread(target=wide)
        task.start()
        task.join(0.1)
        assert task.is_alive()
        assert seen == []
    task.join()
    assert seen == [{2}]
    assert used() == {2}


@pytest.mark.parametrize("executor", ["sync", "threads", "processes"])
def test_a_task_has_one_thread_wherever_it_is_computed(toys, executor, monkeypatch):
    for name in [name for name in os.environ if name.endswith("_NUM_THREADS")]:
        monkeypatch.delenv(name)
    toys.edit(
        "return Smooth(value=rough(",
        "from threadpoolctl import ThreadpoolController\n"
        "    np.ones((2, 2)) @ np.ones((2, 2))\n"
        "    most = max(library['num_threads'] for library in ThreadpoolController().info())\n"
        "    return Smooth(value=1000.0 * most + 0 * rough(",
    )
    toys.run(until=("smooth",), compute={"executor": executor, "workers": 2})
    pipeline = toys.pipeline()
    assert [pipeline.artifact("smooth", frame=n).value for n in range(6)] == [1000.0] * 6


def test_the_instruction_set_of_blas_is_on_record(toys):
    toys.run(until=("smooth",))
    schedule = toys.pipeline().schedule(until=["smooth"])
    (record, *_) = [entry.record for entry in schedule.entries.values() if entry.record is not None]
    assert (record.versions["blas"], record.versions["simd"]) == (blas(), simd())
    assert "openblas" in blas()


def test_numpy_on_another_processor_is_told_apart():
    """Wider registers add up in another order; what numpy is told not to use stands for a processor that has less."""
    usable = np.show_config(mode="dicts")["SIMD Extensions"].get("found")
    if not usable:
        pytest.skip("numpy has one instruction set here")
    ask = [sys.executable, "-c", "from kinetree.pipeline.running.threads import simd; print(simd())"]
    environment = {**os.environ, "NPY_DISABLE_CPU_FEATURES": ",".join(usable)}
    less = subprocess.run(ask, env=environment, capture_output=True, check=True)
    assert less.stdout.decode().split(",")[0].strip() != simd().split(",")[0]


def test_another_instruction_set_is_told_apart():
    told = {}
    for core in ("Nehalem", "Haswell"):
        code = "import json, numpy; from kinetree.pipeline.running.threads import blas; print(json.dumps(blas()))"
        environment = {**os.environ, "OPENBLAS_CORETYPE": core}
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        told[core] = json.loads(done.stdout)
    assert all(core in told[core] for core in told)
