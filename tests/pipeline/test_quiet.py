"""What dask logs while a run lasts."""

import logging

from kinetree.pipeline.running.quiet import LOUD, quiet


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
