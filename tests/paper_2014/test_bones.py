"""Contract of bones: joints where the surface is not rigid, and no ring of bones."""

import networkx as nx
import numpy as np
import pytest
from mesoscopic import SPANS, mesoscopic


def test_joints_are_at_the_middle_of_their_areas_in_every_frame() -> None:
    here = mesoscopic()
    joint = np.flatnonzero(here.bones.part < 0)
    assert here.bones.frames == tuple(range(SPANS[-1].stop))
    assert np.isfinite(here.bones.centroid).all()
    for t in here.bones.frames:
        true = here.body.R[t, 1:] @ here.body.joints[1:, :, None]
        true = true[:, :, 0] + here.body.t[t, 1:]
        distance = np.linalg.norm(here.bones.centroid[t, joint][:, None] - true, axis=2).min(axis=0)
        assert distance == pytest.approx(0.0, abs=1.5)


def test_three_joints_of_one_part_have_three_bones_of_which_one_is_redundant() -> None:
    links = mesoscopic().bones
    assert len(links.bone) == 3
    assert links.in_tree.sum() == 2
    assert nx.is_tree(nx.Graph(links.bone[links.in_tree].tolist()))
    assert links.variation[~links.in_tree].min() >= links.variation[links.in_tree].max()


def test_body_at_rest_is_one_part_without_bones() -> None:
    links = mesoscopic(at_rest=True).bones
    assert (links.part == 0).all()
    assert len(links.bone) == 0
