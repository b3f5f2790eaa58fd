"""How the meshes of successive intervals lie on each other, as the task gives it."""

import numpy as np
from sheets import CORNERS, Frame, exact, followed, frame

from kinetree.pipeline import views
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.paper_2014.cut_correspondence import cut_correspondence
from kinetree.tasks.paper_2014.interval_reference import interval_reference


def crossed(frames: dict[int, Frame], *ends: int) -> tuple[list[IntervalReference], CutCorrespondence]:
    """With alignments that are exact."""
    intervals, leaves = followed(frames, *ends)
    numbers = tuple(frames)
    middles, alignments = [], []
    for a, b in zip(intervals.begin, intervals.end, strict=True):
        mine = {t: frames[t] for t in numbers[int(a) : int(b) + 1]}
        middles.append(
            interval_reference(
                {t: f.mesh for t, f in mine.items()},
                {t: f.geodesics for t, f in mine.items()},
                {t: f.coordinates for t, f in mine.items()},
                intervals,
                leaves,
            )
        )
        place = frames[middles[-1].frame].place
        alignments += [exact(place, f) for f in mine.values()]
    return middles, cut_correspondence(tuple(middles), tuple(alignments), {t: f.tips for t, f in frames.items()}, leaves)


def test_vertices_of_one_reference_lead_to_the_same_places_of_the_next_and_back() -> None:
    frames = {t: frame(t, bend=0.02) for t in range(9)}
    middles, told = crossed(frames, 2, 5, 8)
    count = len(middles[0].vertices)
    assert told.first.tolist() == [0, count, 2 * count]
    for i in (0, 1):
        here, there = frames[middles[i].frame].place, frames[middles[i + 1].frame].place
        assert told.onward[told.rows(i)][here].tolist() == there.tolist()
        assert told.backward[told.rows(i + 1)][there].tolist() == here.tolist()
        assert told.onward_distance[told.rows(i)].max() < 0.25
    assert (told.onward[told.rows(2)] == -1).all()
    assert (told.backward[told.rows(0)] == -1).all()
    assert np.isnan(told.backward_distance[told.rows(0)]).all()


def test_leaves_find_each_other_and_the_one_that_went_is_surplus() -> None:
    frames = {t: frame(t, bend=0.02, hidden=(1,) if t > 3 else ()) for t in range(8)}
    middles, told = crossed(frames, 3, 7)
    assert [m.leaf.tolist() for m in middles] == [[0, 1, 2], [0, 2]]
    assert list(zip(told.cut, told.before, told.behind, strict=True)) == [(0, 0, 0), (0, 2, 1)]
    ends = [f.mesh.vertices[f.place[CORNERS]] for f in (frames[3], frames[4])]
    np.testing.assert_allclose(told.moved, np.linalg.norm(ends[0] - ends[1], axis=1)[[0, 2]])
    assert told.surplus(0, ahead=True) == [1]
    assert told.surplus(1, ahead=False) == []
    assert views.remarks(told) == ("interval 1 has two leaves: the geodesic mapping cannot tell places apart there",)


def test_one_interval_has_no_cut() -> None:
    _, told = crossed({t: frame(t) for t in range(3)}, 2)
    assert (told.onward == -1).all()
    assert (told.backward == -1).all()
    assert len(told.cut) == 0
    assert views.remarks(told) == ()
