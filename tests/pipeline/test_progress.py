"""Laws of progress: counts follow the events, time left is what the mean says, and no name is obeyed by a terminal."""

import io

import pytest
from rich.console import Console

from kinetree.pipeline.command_line import progress
from kinetree.pipeline.command_line.printable import printable
from kinetree.pipeline.command_line.progress import LiveProgress, PlainProgress, Rows, clock


def events(*told):
    for kind, *rest in told:
        if kind == "layout":
            yield {"event": kind, "totals": rest[0]}
        else:
            task, *more = rest
            yield {"event": kind, "task": task, "node": f"{task}[frame=0]", "message": "", **(more[0] if more else {})}


def rows(*what, workers=1):
    counted = Rows(workers)
    for event in events(*what):
        counted.hear(event)
    return counted


def console(**options):
    return Console(file=io.StringIO(), width=100, **options)


@pytest.fixture
def plain(monkeypatch):
    """Plain lines of a run, by a clock that the test turns."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    out = console()

    def hear(*what, seconds=0.0):
        now[0] += seconds
        for event in events(*what):
            printer.hear(event)
        return out.file.getvalue()

    printer = PlainProgress(out, 2)
    return hear


def test_counts_follow_the_events():
    row = rows(
        ("layout", {"mesh": 6}),
        ("fresh", "mesh"),
        ("start", "mesh"), ("finish", "mesh", {"seconds": 2.0}),
        ("start", "mesh"), ("failed", "mesh", {"seconds": 1.0}),
        ("skipped", "mesh"),
        ("start", "mesh"),
    ).rows["mesh"]  # fmt: skip
    assert (row.fresh, row.ran, row.failed, row.skipped, row.running) == (1, 1, 1, 1, 1)
    assert (row.done, row.total, row.seconds) == (4, 6, 3.0)


def test_node_that_turns_out_fresh_after_it_was_sent_is_not_running():
    row = rows(("layout", {"mesh": 1}), ("start", "mesh"), ("fresh", "mesh")).rows["mesh"]
    assert (row.running, row.done) == (0, 1)


def test_time_left_is_what_is_left_by_the_mean_over_the_workers():
    counted = rows(("layout", {"mesh": 5}), *[("start", "mesh"), ("finish", "mesh", {"seconds": 2.0})] * 2, workers=3)
    assert counted.seconds_left(counted.rows["mesh"]) == pytest.approx(3 * 2.0 / 3)


def test_time_left_is_unknown_before_anything_ran_and_none_at_the_end():
    counted = rows(("layout", {"mesh": 2}), ("fresh", "mesh"))
    assert counted.seconds_left(counted.rows["mesh"]) is None
    counted.hear({"event": "fresh", "task": "mesh"})
    assert counted.seconds_left(counted.rows["mesh"]) == 0


def test_events_of_no_task_change_nothing():
    assert rows(("layout", {})).rows == {}
    counted = rows()
    counted.hear({"event": "run"})
    counted.hear({"event": "end"})
    assert counted.rows == {}


def test_plain_progress_has_one_line_a_task_when_it_is_through(plain):
    finish = ("finish", "mesh", {"seconds": 0.25})
    assert plain(("layout", {"mesh": 3}), ("fresh", "mesh"), ("start", "mesh"), finish) == ""
    assert plain(("start", "mesh"), finish) == "mesh: 2 ran, 1 fresh, 0.5 s\n"


def test_plain_progress_tells_every_few_seconds_how_far_it_is(plain):
    finish = ("finish", "mesh", {"seconds": 4.0})
    assert plain(("layout", {"mesh": 9}), finish) == ""
    assert plain(finish, seconds=6) == "mesh: 2 of 9, 14 s left\n"
    assert plain(finish, seconds=1) == "mesh: 2 of 9, 14 s left\n"


def test_plain_progress_tells_a_failure_at_once_and_safely(plain):
    told = plain(("layout", {"mesh": 9}), ("failed", "mesh", {"message": "[red]a\nb\x1b[31m.ply is empty"}))
    assert told == "mesh[frame=0]: failed: [red]a\\nb\\x1b[31m.ply is empty\n"


def test_live_progress_shows_rows_and_leaves_the_terminal_whole():
    out = console(force_terminal=True)
    with LiveProgress(out, 2) as progress:
        for event in events(
            ("layout", {"mesh": 3, "sequence": 1}), ("fresh", "sequence"), ("failed", "mesh"), ("skipped", "mesh")
        ):
            progress.hear(event)
    output = out.file.getvalue()
    assert "mesh" in output
    assert "2/3" in output
    assert "1/1" in output
    assert output.count("\x1b[?25l") == output.count("\x1b[?25h") == 1  # the cursor was hidden and is back


def test_live_progress_leaves_the_terminal_whole_when_interrupted():
    out = console(force_terminal=True)
    with pytest.raises(KeyboardInterrupt), LiveProgress(out, 2):
        raise KeyboardInterrupt
    assert out.file.getvalue().count("\x1b[?25h") == 1


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(0, "0.0 s"), (8.04, "8.0 s"), (9.96, "10.0 s"), (42.4, "42 s"), (59.6, "1:00"), (200, "3:20"),
     (3600, "1:00:00"), (3905, "1:05:05")],
)  # fmt: skip
def test_durations_are_told_at_a_glance(seconds, told):
    assert clock(seconds) == told


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("plain μ 日本 😀 [red] <b>", "plain μ 日本 😀 [red] <b>"),
        ("\x1b[31m", "\\x1b[31m"),
        ("a\r\nb\tc", "a\\r\\nb\\tc"),
        ("\u202eabc\u200b", "\\u202eabc\\u200b"),
        ("\x9b\x7f", "\\x9b\\x7f"),
        ("\udcff", "\\udcff"),
    ],
)
def test_what_a_terminal_would_obey_is_written_out(text, told):
    assert printable(text) == told
    assert printable("a\n" + text, lines=True).startswith("a\n")
