"""Contract of node_clusters: what turns together is one cluster."""

import numpy as np
from volumetric import volumetric


def test_clusters_are_the_rigid_parts_of_the_body() -> None:
    here = volumetric()
    part, true = here.node_clusters[0].part, here.body.label
    agreeing = sum(np.bincount(true[part == p]).max() for p in np.unique(part))
    assert 4 <= len(np.unique(part)) <= 5
    assert agreeing > 0.95 * len(true)


def test_velocities_correlate_within_an_arm_and_not_across_its_joint() -> None:
    here = volumetric()
    model, r = here.initial_model[0], here.node_clusters[0].correlation
    outer = np.linalg.norm(model.node, axis=1) > 17.0
    within = outer[1:] & outer[model.parents[1:]]
    assert r[1:][within].min() > 0.9
