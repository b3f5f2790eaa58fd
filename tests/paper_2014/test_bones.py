"""Contract of bones: joints where the surface is not rigid, and no ring of bones."""

import networkx as nx
import numpy as np
import pytest
from mesoscopic import SPANS, made


def test_joints_are_at_the_middle_of_their_areas_in_every_frame() -> None:
    here = made()
    joint = np.flatnonzero(here.bones.body < 0)
    assert here.bones.frames == tuple(range(SPANS[-1].stop))
    assert np.isfinite(here.bones.centroid).all()
    for t in here.bones.frames:
        true = here.body.R[t, 1:] @ here.body.joints[1:, :, None]
        true = true[:, :, 0] + here.body.t[t, 1:]
        away = np.linalg.norm(here.bones.centroid[t, joint][:, None] - true, axis=2).min(axis=0)
        assert away == pytest.approx(0.0, abs=1.5)


def test_three_joints_of_one_body_have_three_bones_of_which_one_is_redundant() -> None:
    told = made().bones
    assert len(told.bone) == 3
    assert told.kept.sum() == 2
    assert nx.is_tree(nx.Graph(told.bone[told.kept].tolist()))
    assert told.variation[~told.kept].min() >= told.variation[told.kept].max()


def test_still_body_is_one_body_without_bones() -> None:
    told = made(still=True).bones
    assert (told.body == 0).all()
    assert len(told.bone) == 0
