"""Correspondences between the meshes of successive intervals, as the task gives them."""

import numpy as np
from sheets import CORNERS, Frame, exact, frame, reference_of

from kinetree.pipeline import views
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.paper_2014.cut_correspondence import cut_correspondence


def corresponding(frames: dict[int, Frame], *ends: int) -> tuple[list[IntervalReference], CutCorrespondence]:
    """With alignments that are exact."""
    references = [reference_of(frames, i, *ends) for i in range(len(ends))]
    alignments = [exact(frames[r.frame].number, frames[t]) for r in references for t in r.frames]
    extrema = {t: f.extrema for t, f in frames.items()}
    return references, cut_correspondence(tuple(references), tuple(alignments), extrema)


def test_vertices_of_one_reference_correspond_to_the_same_places_of_the_next_and_back() -> None:
    frames = {t: frame(t, bend=0.02) for t in range(9)}
    references, cuts = corresponding(frames, 2, 5, 8)
    count = len(references[0].vertices)
    assert cuts.first.tolist() == [0, count, 2 * count]
    for i in (0, 1):
        here, there = frames[references[i].frame].number, frames[references[i + 1].frame].number
        assert cuts.to_next[cuts.rows(i)][here].tolist() == there.tolist()
        assert cuts.to_previous[cuts.rows(i + 1)][there].tolist() == here.tolist()
        assert cuts.to_next_distance[cuts.rows(i)].max() < 0.25
    assert (cuts.to_next[cuts.rows(2)] == -1).all()
    assert (cuts.to_previous[cuts.rows(0)] == -1).all()
    assert np.isnan(cuts.to_previous_distance[cuts.rows(0)]).all()


def test_maps_are_those_of_each_cut() -> None:
    references, cuts = corresponding({t: frame(t, bend=0.02) for t in range(9)}, 2, 5, 8)
    to_next, to_previous = cuts.maps()
    assert [len(m) for m in (*to_next, *to_previous)] == [len(references[0].vertices)] * 4
    assert to_next[1].tolist() == cuts.to_next[cuts.rows(1)].tolist()
    assert to_previous[1].tolist() == cuts.to_previous[cuts.rows(2)].tolist()


def test_leaves_are_paired_and_the_one_that_disappeared_is_surplus() -> None:
    frames = {t: frame(t, bend=0.02, hidden=(1,) if t > 3 else ()) for t in range(8)}
    references, cuts = corresponding(frames, 3, 7)
    assert [r.leaf.tolist() for r in references] == [[0, 1, 2], [0, 2]]
    assert list(zip(cuts.cut, cuts.leaf_before, cuts.leaf_after, strict=True)) == [(0, 0, 0), (0, 2, 1)]
    ends = [f.mesh.vertices[f.number[CORNERS]] for f in (frames[3], frames[4])]
    np.testing.assert_allclose(cuts.leaf_distance, np.linalg.norm(ends[0] - ends[1], axis=1)[[0, 2]])
    assert cuts.surplus(0, at_end=True) == [1]
    assert cuts.surplus(1, at_end=False) == []
    (remark,) = views.remarks(cuts)
    assert remark.startswith("interval 1 has two leaves; geodesic coordinates need three")


def test_one_interval_has_no_cut() -> None:
    _, cuts = corresponding({t: frame(t) for t in range(3)}, 2)
    assert (cuts.to_next == -1).all()
    assert (cuts.to_previous == -1).all()
    assert len(cuts.cut) == 0
    assert cuts.maps() == ([], [])
    assert views.remarks(cuts) == ()


def test_reference_with_handles_is_remarked() -> None:
    _, cuts = corresponding({t: frame(t) for t in range(3)}, 2)
    (remark,) = views.remarks(cuts.model_copy(update={"genus": (2,)}))
    assert remark.startswith("the surface of interval 0 has 2 handles, ")
