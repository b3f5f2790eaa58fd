"""Where the sequence is cut, as the task says it."""

import numpy as np

from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.topology.correlation import Correlation
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.intervals import IntervalsParams
from kinetree.tasks.numerics.topology.correlation import correlations
from kinetree.tasks.topology.intervals import intervals

ANEW = Connectivity(fixed=False, first_change=1, vertices=4, faces=4)
TRACKED = Connectivity(fixed=True, first_change=None, vertices=4, faces=4)


def tip(*peaks: float, euler: int = 2) -> Extrema:
    none = np.zeros(0)
    return Extrema(
        vertices=none.astype(int), persistence=none, stems=np.zeros((0, 5, 3)), normals=np.zeros((0, 3)), value=none,
        peaks=np.array(peaks), loops=none, size=1.0, centre=(0.0, 0.0, 0.0), euler=euler, components=1,
    )  # fmt: skip


def series(*states: int) -> Correlation:
    H = np.eye(4)[list(states)]
    return Correlation(histograms=H, correlation=correlations(H))


def test_still_sequence_is_one_interval_numbered_by_its_own_frames() -> None:
    division = intervals(series(0, 0, 0, 0), {n: tip(1.0) for n in (10, 12, 14, 16)}, ANEW, IntervalsParams())
    assert list(division.members("interval", ())) == [0]
    assert list(division.members("interval/frame", (0,))) == [10, 12, 14, 16]
    assert division.cues == ()


def test_two_frames_are_one_interval() -> None:
    division = intervals(series(0, 1), {0: tip(1.0), 1: tip(1.0)}, ANEW, IntervalsParams())
    assert list(division.members("interval/frame", (0,))) == [0, 1]


def test_drop_that_lasts_cuts_and_the_cue_is_named() -> None:
    states = [0] * 6 + [1] * 6
    division = intervals(series(*states), {n: tip(1.0) for n in range(12)}, ANEW, IntervalsParams())
    assert [list(division.members("interval/frame", (i,))) for i in division.members("interval", ())] == [
        list(range(6)), list(range(6, 12))
    ]  # fmt: skip
    assert division.cues == (("correlation",),)


def test_lost_leaf_cuts_where_the_correlation_is_blind_unless_it_may_not() -> None:
    tips = {n: tip(1.0, 0.5, 0.4 if n < 6 else 0.05) for n in range(12)}
    assert intervals(series(*[0] * 12), tips, ANEW, IntervalsParams()).cues == (("leaves",),)
    silenced = intervals(series(*[0] * 12), tips, ANEW, IntervalsParams(cues=("correlation",)))
    assert silenced.cues == ()
    leaves = silenced.strengths[silenced.cue_names.index("leaves")]
    assert np.flatnonzero(leaves >= 1).tolist() == [5], "a cue that may not cut still tells how near it came"


def test_fixed_rule_cuts_at_the_threshold_and_nowhere_else() -> None:
    params = IntervalsParams(rule="fixed", threshold=0.5, minimum=1)
    division = intervals(series(0, 0, 1, 1, 1), {n: tip(1.0) for n in range(5)}, ANEW, params)
    assert division.end.tolist() == [1, 4]
    assert division.threshold == 0.5


def test_sequence_of_fixed_connectivity_is_one_interval_if_the_paper_is_followed() -> None:
    states, tips = series(*[0] * 6, *[1] * 6), {n: tip(1.0) for n in range(20, 32)}
    whole = IntervalsParams(tracked="whole")
    assert len(intervals(states, tips, TRACKED, IntervalsParams()).begin) == 2
    assert len(intervals(states, tips, ANEW, whole).begin) == 2
    division = intervals(states, tips, TRACKED, whole)
    assert list(division.members("interval/frame", (0,))) == list(range(20, 32))
    assert (division.cues, division.z.shape) == ((), (11,))
