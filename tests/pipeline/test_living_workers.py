"""Runs whose workers or scheduler are gone, or whose workers are too small, end in words."""

import time

import pytest

from kinetree.errors import ClusterError
from kinetree.pipeline.running.living_workers import LivingWorkers


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


def test_nothing_stays_of_a_parcel_whose_beginning_is_heard_of_when_it_is_over():
    workers, begins = LivingWorkers(patience=0.0), (0.0, {"key": "parcel", "worker": "a"})
    workers.expect("parcel")
    workers.hear_of_parcel(begins)
    assert workers.is_begun("parcel", "a")
    workers.forget("parcel")
    workers.hear_of_parcel(begins)
    assert not workers.began


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
