"""Laws of the finished body, on a tube of two links whose joint is a band of the surface."""

import numpy as np
import pytest
from articulated import chain, swings

from kinetree.tasks.numerics.paper_2014.across_cuts import centroids
from kinetree.tasks.numerics.paper_2014.assembly import hung
from kinetree.tasks.numerics.paper_2014.kinematic_structure import kinematic_structure

BODY = chain((0.0,), swings(16, 2, degrees=60.0, axes=1), blend=1.0)
LABEL = np.digitize(BODY.V[:, 2], [-0.5, 0.5])
AREAS = np.array([0, -1, 1])
TIP = np.array([np.argmin(BODY.V[:, 2]), np.argmax(BODY.V[:, 2])])


def built(label=LABEL, body=AREAS, touches=((False, True, False), (False, True, False)), size=(2.0, 1.0)):
    tree = hung(np.zeros((0, 2), int), np.zeros(0, int), np.array(touches, bool), np.ones(len(body)), np.array(size))
    X = centroids(BODY.x, label, BODY.area, len(body))
    return kinematic_structure(BODY.V, BODY.area, BODY.x, label, body, tree, X, TIP, BODY.x[:, TIP])


def test_two_links_have_one_joint_where_they_meet_and_two_ends():
    found = built()
    assert found.kinds.count("joint") == 1
    assert found.kinds.count("leaf") == 2
    joint = found.kinds.index("joint")
    assert np.linalg.norm(found.positions[:, joint], axis=1).max() < 0.5, "it is at the origin in every frame"
    assert found.degrees[joint] == pytest.approx(120, abs=15)
    assert found.confidence.min() > 0.9


def test_joints_follow_their_parents_as_the_convention_has_it():
    found = built()
    for j, p in enumerate(found.parents):
        if p >= 0:
            carried = found.positions[:, p] + found.rotation[:, p] @ (found.rest[j] - found.rest[p])
            np.testing.assert_allclose(carried, found.positions[:, j], atol=1e-9)


def test_joint_area_is_not_rigid_and_follows_both_sides():
    found = built()
    assert (found.label[LABEL == 1] == -1).all()
    assert len(np.unique(found.label[LABEL != 1])) == 2
    np.testing.assert_allclose(found.weight.sum(axis=1), 1.0)
    assert (found.weight[LABEL == 1].max(axis=1) == 0.5).all()


def test_body_without_a_joint_is_a_root_and_its_leaves():
    found = built(np.zeros(len(BODY.V), int), np.array([0]), [[False]], (1.0,))
    assert found.kinds == ("root", "leaf", "leaf")
    assert (found.label == 0).all()


def test_body_that_is_nowhere_rigid_is_a_root_that_says_so():
    tree = hung(np.zeros((0, 2), int), np.zeros(0, int), np.zeros((0, 1), bool), np.ones(1), np.zeros(0))
    label = np.zeros(len(BODY.V), int)
    X = centroids(BODY.x, label, BODY.area, 1)
    found = kinematic_structure(BODY.V, BODY.area, BODY.x, label, np.array([-1]), tree, X, TIP, BODY.x[:, TIP])
    assert found.kinds[0] == "root"
    assert (found.label == -1).all()
