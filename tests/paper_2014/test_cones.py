"""Contract of cones: annuli around every leaf of an interval."""

import numpy as np
from mesoscopic import leaf_vertices, mesoscopic

from kinetree.schemas.paper_2014.cones import ConesParams
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.paper_2014.cones import cones


def test_every_cone_begins_at_its_leaf_and_ends_where_the_body_branches() -> None:
    here = mesoscopic()
    for leaf, annulus in enumerate(here.cones[0].annulus):
        assert annulus[leaf_vertices(here.body)[leaf]] == 0
        reach = here.interval_references[0].coordinates[leaf][annulus >= 0].max()
        assert 20.0 < reach < 34.0, "an arm is 28 long"


def test_cone_has_the_range_of_mu_and_a_leaf_that_is_not_seen_has_none() -> None:
    here = mesoscopic()
    reference = here.interval_references[0]
    blind = reference.model_copy(update={"leaf_vertex": np.array([-1, *reference.leaf_vertex[1:]])})
    mu = reference.coordinates.sum(axis=0)
    distances = Geodesics(mu=mu, area=here.body.area, bases=np.zeros(0, int), share=1.0)
    artifact = cones(blind, {blind.frame: distances}, ConesParams())
    assert (artifact.annulus[0] == -1).all()
    assert artifact.mu_range[0] == 0.0
    assert artifact.mu_range[1] == np.ptp(mu[artifact.annulus[1] >= 0])
