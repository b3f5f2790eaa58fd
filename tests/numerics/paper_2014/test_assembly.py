"""Laws of hanging joints on bodies and of fixed lengths."""

import numpy as np
from articulated import chain, swings

from kinetree.tasks.numerics.paper_2014.assembly import Hung, hung, posed, rotations
from kinetree.tasks.numerics.structure.articulated_fit import placed

BODY = chain((-2.0, 2.0), swings(16, 3, degrees=40.0))
TREE = Hung(np.array([-1, 0, 1]), np.array([1, 0, 2]), np.array([-1, 0, 0]))


def touching(*pairs, bodies, areas):
    out = np.zeros((bodies, areas), bool)
    for body, area in pairs:
        out[body, area] = True
    return out


def test_chain_hangs_from_its_largest_body():
    touches = touching((0, 1), (1, 1), (1, 3), (2, 3), bodies=3, areas=5)
    tree = hung(np.array([[1, 3]]), np.array([1]), touches, np.ones(5), np.array([1.0, 3.0, 1.0]))
    assert tree.joint.tolist() == [-1, 1, 3]
    assert tree.carries.tolist() == [1, 0, 2]
    assert tree.parents.tolist() == [-1, 0, 0]


def test_joint_beyond_which_two_bodies_turn_has_a_node_for_each():
    touches = touching((0, 3), (1, 3), (2, 3), bodies=3, areas=4)
    tree = hung(np.zeros((0, 2), int), np.zeros(0, int), touches, np.ones(4), np.array([9.0, 1.0, 1.0]))
    assert tree.joint.tolist() == [-1, 3, 3]
    assert tree.carries.tolist() == [0, 1, 2]


def test_joint_beyond_which_nothing_is_carries_itself():
    touches = touching((0, 1), bodies=1, areas=3)
    tree = hung(np.array([[1, 2]]), np.array([-1]), touches, np.ones(3), np.array([9.0]))
    assert tree.joint.tolist() == [-1, 1, 2]
    assert tree.carries.tolist() == [0, -1, -1]
    assert tree.parents.tolist() == [-1, 0, 1]


def test_ring_of_bodies_is_cut_once():
    touches = touching((0, 0), (0, 1), (1, 0), (1, 1), bodies=2, areas=2)
    tree = hung(np.array([[0, 1]]), np.array([0]), touches, np.ones(2), np.array([9.0, 1.0]))
    assert sorted(tree.joint.tolist()) == [-1, 0, 1]
    assert sorted(tree.carries.tolist()) == [-1, 0, 1]


def test_body_without_joints_is_a_root():
    tree = hung(np.zeros((0, 2), int), np.zeros(0, int), np.zeros((1, 1), bool), np.ones(1), np.ones(1))
    assert (tree.joint.tolist(), tree.carries.tolist(), tree.parents.tolist()) == ([-1], [0], [-1])
    tree = hung(np.zeros((0, 2), int), np.zeros(0, int), np.zeros((0, 1), bool), np.ones(1), np.zeros(0))
    assert tree.parents.tolist() == [-1]


def test_rotations_are_those_of_the_part_and_stay_where_nothing_is_seen():
    y = BODY.x.copy()
    mine = BODY.label == 2
    np.testing.assert_allclose(rotations(BODY.V, y, mine), BODY.R[:, 2], atol=1e-9)
    y[5:] = np.nan
    np.testing.assert_allclose(rotations(BODY.V, y, mine)[5:], np.broadcast_to(BODY.R[4, 2], (11, 3, 3)), atol=1e-9)


def known(noise=0.0):
    """The chain with its middle as root: nodes are the middle, the low and the high part."""
    order = [1, 0, 2]
    joints = np.array([[0, 0, 0], [0, 0, -2.0], [0, 0, 2.0]])
    R, t = BODY.R[:, order], BODY.t[:, order]
    X = np.einsum("txy,ny->tnx", R[:, 0], joints) + t[:, :1]
    X = X + np.random.default_rng(0).normal(0, noise, X.shape)
    tip = np.array([np.argmin(BODY.V[:, 2]), np.argmax(BODY.V[:, 2])])
    of = np.argsort(order)[BODY.label]
    found = posed(BODY.V, BODY.x, of, TREE, X, R, joints[0], np.array([1, 2]), BODY.x[:, tip])
    return found, X, tip


def test_lengths_that_are_fixed_already_are_left_and_fit_exactly():
    found, X, tip = known()
    np.testing.assert_allclose(found.positions, X, atol=1e-6)
    np.testing.assert_allclose(found.ends, BODY.x[:, tip], atol=1e-6)
    assert found.drift.max() < 1e-6


def test_lengths_are_equal_in_all_frames_however_joints_shake():
    found, _, _ = known(noise=0.1)
    length = np.linalg.norm(found.positions[:, 1:] - found.positions[:, :1], axis=2)
    assert np.ptp(length, axis=0).max() < 1e-9
    np.testing.assert_allclose(placed(found.motion, TREE.parents), found.positions)
    assert 0.01 < found.drift.max() < 0.3
