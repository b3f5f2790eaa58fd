"""Contract of cone consistency: every interval has every cone."""

import numpy as np
from mesoscopic import mesoscopic

from kinetree.pipeline import views
from kinetree.schemas.paper_2014.cone_consistency import ConeConsistencyParams
from kinetree.schemas.paper_2014.cones import Cones
from kinetree.schemas.paper_2014.cut_correspondence import CutCorrespondence
from kinetree.tasks.paper_2014.cone_consistency import cone_consistency


def test_cone_that_an_interval_does_not_see_is_recovered_there() -> None:
    consistent = mesoscopic().cone_consistency
    assert consistent.leaf.tolist() == [[0, 1, 2], [0, -1, 1]]
    assert (consistent.annulus[1, consistent.rows(1)] == consistent.annulus[1, consistent.rows(0)]).all()
    assert views.remarks(consistent) == ("cone 1 is missing in interval 1; it was recovered from the neighbouring intervals",)


def test_every_interval_has_the_same_cones() -> None:
    consistent = mesoscopic().cone_consistency
    assert [list(consistent.members("interval/cone", (i,))) for i in (0, 1)] == [[0, 1, 2]] * 2


def test_body_without_leaves_has_no_cones_and_says_so() -> None:
    here = mesoscopic()
    count = len(here.body.V)
    bare = tuple(
        r.model_copy(update={"leaf": np.zeros(0, int), "leaf_vertex": np.zeros(0, int), "coordinates": np.zeros((0, count))})
        for r in here.interval_references
    )
    none = Cones(annuli=25, annulus=np.zeros((0, count), int), mu_range=np.zeros(0))
    unmatched = {
        name: getattr(here.cut_correspondence, name)[:0] for name in ("cut", "leaf_before", "leaf_after", "leaf_distance")
    }
    unmatched_cuts = CutCorrespondence(**{**here.cut_correspondence.arrays(), **unmatched, "leaf_count": np.zeros(2, int)})
    consistent = cone_consistency(bare, (none, none), unmatched_cuts, ConeConsistencyParams())
    assert list(consistent.members("interval/cone", (0,))) == []
    assert "one rigid part" in views.remarks(consistent)[0]
