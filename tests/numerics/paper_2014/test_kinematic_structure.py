"""Laws of the finished body, on a tube of two links whose joint is a band of the surface."""

import numpy as np
import pytest
from articulated import chain, swings

from kinetree.tasks.numerics.paper_2014.bones import area_centroids
from kinetree.tasks.numerics.paper_2014.joint_tree import joint_tree
from kinetree.tasks.numerics.paper_2014.kinematic_structure import KinematicStructureSettings, Model, kinematic_structure

BODY = chain((0.0,), swings(16, 2, degrees=60.0, axes=1), blend=1.0)
LABEL = np.digitize(BODY.V[:, 2], [-0.5, 0.5])
PARTS = np.array([0, -1, 1])
TIP = np.array([np.argmin(BODY.V[:, 2]), np.argmax(BODY.V[:, 2])])


def built(label=LABEL, part=PARTS, of_part=((False, True, False), (False, True, False)), size=(2.0, 1.0), settings=None):
    tree = joint_tree(np.zeros((0, 2), int), np.zeros(0, int), np.array(of_part, bool), np.ones(len(part)), np.array(size))
    X = area_centroids(BODY.x, label, BODY.area, len(part))
    model = Model(BODY.V, BODY.area, label, part)
    return kinematic_structure(model, BODY.x, tree, X, TIP, BODY.x[:, TIP], settings=settings)


def test_two_links_have_one_joint_where_they_meet_and_two_ends():
    body = built()
    assert body.kinds.count("joint") == 1
    assert body.kinds.count("leaf") == 2
    joint = body.kinds.index("joint")
    assert np.linalg.norm(body.positions[:, joint], axis=1).max() < 0.5, "it is at the origin in every frame"
    assert body.degrees[joint] == pytest.approx(120, abs=15)
    assert body.confidence.min() > 0.9


def test_joints_follow_their_parents():
    body = built()
    for j, p in enumerate(body.parents):
        if p >= 0:
            carried = body.positions[:, p] + body.rotation[:, p] @ (body.rest[j] - body.rest[p])
            np.testing.assert_allclose(carried, body.positions[:, j], atol=1e-9)


def test_joint_area_is_not_rigid_and_follows_both_sides():
    body = built()
    assert (body.label[LABEL == 1] == -1).all()
    assert len(np.unique(body.label[LABEL != 1])) == 2
    np.testing.assert_allclose(body.weight.sum(axis=1), 1.0)
    assert (body.weight[LABEL == 1].max(axis=1) == 0.5).all()


def test_body_without_a_joint_is_a_root_and_its_leaves():
    body = built(np.zeros(len(BODY.V), int), np.array([0]), [[False]], (1.0,))
    assert body.kinds == ("root", "leaf", "leaf")
    assert (body.label == 0).all()


def test_body_without_rigid_areas_is_a_root_without_labels():
    tree = joint_tree(np.zeros((0, 2), int), np.zeros(0, int), np.zeros((0, 1), bool), np.ones(1), np.zeros(0))
    label = np.zeros(len(BODY.V), int)
    X = area_centroids(BODY.x, label, BODY.area, 1)
    model = Model(BODY.V, BODY.area, label, np.array([-1]))
    body = kinematic_structure(model, BODY.x, tree, X, TIP, BODY.x[:, TIP])
    assert body.kinds[0] == "root"
    assert (body.label == -1).all()


def test_confidence_is_one_half_where_the_settings_say():
    strict = built(settings=KinematicStructureSettings(half_confidence=1e-4))
    assert strict.confidence.min() < built().confidence.min()
