"""Contract of consistency: every interval has every cone."""

import numpy as np
from mesoscopic import made

from kinetree.pipeline import views
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistencyParams
from kinetree.schemas.paper_2014.cones import Cones
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.tasks.paper_2014.cone_consistency import cone_consistency


def test_cone_that_an_interval_does_not_see_is_recovered_there() -> None:
    told = made().consistency
    assert told.leaf.tolist() == [[0, 1, 2], [0, -1, 1]]
    assert (told.ring[1, told.rows(1)] == told.ring[1, told.rows(0)]).all()
    assert views.remarks(told) == ("cone 1 is not seen in interval 1 and was recovered from its neighbours",)


def test_every_interval_has_the_same_members_each_behind_the_one_before() -> None:
    told = made().consistency
    assert [list(told.members("interval/cone", (i,))) for i in (0, 1)] == [[0, 1, 2]] * 2
    assert [told.previous(c) for c in range(3)] == [None, 0, 1]


def test_body_without_leaves_has_no_cones_and_says_so() -> None:
    here = made()
    count = len(here.body.V)
    bare = tuple(
        m.model_copy(update={"leaf": np.zeros(0, int), "tip": np.zeros(0, int), "distance": np.zeros((0, count))})
        for m in here.middle
    )
    none = Cones(annuli=25, ring=np.zeros((0, count), int), span=np.zeros(0))
    unmatched = {name: getattr(here.crossing, name)[:0] for name in ("cut", "before", "behind", "moved")}
    crossing = CutCorrespondence(**{**here.crossing.arrays(), **unmatched, "leaves": np.zeros(2, int)})
    told = cone_consistency(bare, (none, none), crossing, ConeConsistencyParams())
    assert list(told.members("interval/cone", (0,))) == []
    assert "one rigid part" in views.remarks(told)[0]
