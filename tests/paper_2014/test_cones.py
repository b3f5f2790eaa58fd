"""Contract of cones: annuli around every leaf of an interval."""

import numpy as np
from mesoscopic import made, tips

from kinetree.schemas.paper_2014.cones import ConesParams
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.paper_2014.cones import cones


def test_every_cone_begins_at_its_leaf_and_ends_where_the_body_branches() -> None:
    here = made()
    for leaf, ring in enumerate(here.cones[0].ring):
        assert ring[tips(here.body)[leaf]] == 0
        reach = here.middle[0].distance[leaf][ring >= 0].max()
        assert 20.0 < reach < 34.0, "an arm is 28 long"


def test_cone_has_the_range_of_mu_and_a_leaf_that_is_not_seen_has_none() -> None:
    here = made()
    blind = here.middle[0].model_copy(update={"tip": np.array([-1, *here.middle[0].tip[1:]])})
    mu = here.middle[0].distance.sum(axis=0)
    given = Geodesics(mu=mu, area=here.body.area, bases=np.zeros(0, int), share=1.0)
    told = cones(blind, {blind.frame: given}, ConesParams())
    assert (told.ring[0] == -1).all()
    assert told.span[0] == 0.0
    assert told.span[1] == np.ptp(mu[told.ring[1] >= 0])
