"""Laws of coherence: conditions (i) and (ii), no loop, runs long enough."""

import numpy as np

from kinetree.tasks.numerics.paper_2009.coherent_intervals import coherent_intervals

HUMAN = [(4, 3), (3, 3, 3)]


def test_frames_with_other_ends_or_a_loop_divide_the_sequence() -> None:
    ends, loops = np.array([5, 5, 5, 4, 5, 5, 5, 5]), np.array([0, 0, 0, 0, 1, 0, 0, 0])
    runs = coherent_intervals(ends, loops, [(4, 3)] * 8, ends=5, branches=HUMAN)
    assert (runs.begin.tolist(), runs.end.tolist()) == ([0, 5], [2, 7])


def test_star_of_five_is_no_human_and_yet_its_own_topology() -> None:
    ends, loops = np.full(4, 5), np.zeros(4, np.int64)
    assert not coherent_intervals(ends, loops, [(5,)] * 4, ends=5, branches=HUMAN).coherent.any()
    assert coherent_intervals(ends, loops, [(5,)] * 4).coherent.all()


def test_prevailing_number_of_ends_is_that_of_frames_without_a_loop() -> None:
    ends, loops = np.array([4, 4, 4, 5, 5]), np.array([1, 1, 1, 0, 0])
    runs = coherent_intervals(ends, loops, [(4, 3)] * 5, minimum=2)
    assert (runs.ends, runs.begin.tolist()) == (5, [3])


def test_short_runs_are_no_interval() -> None:
    ends = np.array([5, 5, 4, 5, 5, 5])
    runs = coherent_intervals(ends, np.zeros(6, np.int64), [(3, 3, 3)] * 6, minimum=3)
    assert (runs.begin.tolist(), runs.end.tolist()) == ([3], [5])
