"""Nodes that kill the process of their worker: each is named, and nobody else is, wherever in its parcel it stands."""

from collections import Counter

import pytest

from kinetree.pipeline.planning.together import STRETCH

COUNT = 20
ONE = {"executor": "processes", "workers": 1}
TRIES = 2
"""Of a parcel by dask, before it gives it up."""
LINK, APART = '@task(over="frame", along=Row)', '@task(over="frame")\ndef apart('


@pytest.fixture
def links(toys):
    """A chain of twenty links."""
    toys.main = "toy_links"
    return toys


def deaths(links, name):
    """How often a node began; one that kills its worker dies as often."""
    return links.executions().count(name)


@pytest.mark.parametrize("frame", [0, STRETCH // 2, STRETCH - 1])
def test_a_link_that_kills_its_workers_is_named_and_the_links_before_it_are_kept(links, frame):
    links.flag(f"slay-link-{frame}")
    run = links.run(compute=ONE, until=("link",))
    (failure,) = run.told["failures"]
    assert (failure["node"], failure["error"]) == (f"link[frame={frame}]", "LostWorkerError")
    assert run.heard.nodes("skipped") == [f"link[frame={n}]" for n in range(frame + 1, COUNT)]
    assert Counter(links.executions()) == {f"link-{frame}": 2 * TRIES} | {f"link-{n}": 1 for n in range(frame)}


def test_links_that_are_computed_again_on_request_leave_no_doubt_who_kills(links):
    """All have records from before, so that those do not tell how far a worker came."""
    frame = STRETCH // 2
    links.run(until=("link",))
    links.clear()
    links.flag(f"slay-link-{frame}")
    run = links.run(compute=ONE, until=("link",), force=("link",))
    (failure,) = run.told["failures"]
    assert failure["node"] == f"link[frame={frame}]"
    assert deaths(links, f"link-{frame}") == 2 * TRIES
    assert run.ran == {f"link[frame={n}]" for n in range(frame)}


@pytest.mark.parametrize("frame", [0, STRETCH // 2, STRETCH - 1])
def test_a_link_that_is_never_tried_again_is_the_one_that_is_named(links, frame):
    links.edit(LINK, LINK.replace("along=Row", "along=Row, retries=0"), "toy_links.py")
    links.flag(f"slay-link-{frame}")
    run = links.run(compute=ONE, until=("link",))
    (failure,) = run.told["failures"]
    assert (failure["node"], failure["error"]) == (f"link[frame={frame}]", "LostWorkerError")
    assert Counter(links.executions()) == {f"link-{frame}": TRIES} | {f"link-{n}": 1 for n in range(frame)}


def test_what_only_waited_on_a_worker_that_died_is_not_blamed(links):
    """One worker: behind the node that kills it others wait there, and are lost with it as often."""
    links.edit(APART, APART.replace('"frame"', '"frame", retries=0'), "toy_links.py")
    links.flag("slay-apart-3")
    run = links.run(compute=ONE, until=("apart",))
    assert [failure["node"] for failure in run.told["failures"]] == ["apart[frame=3]"]
    assert deaths(links, "apart-3") == TRIES
    assert len(run.ran | set(run.heard.nodes("fresh"))) == COUNT - 1
