"""Laws of rotations and of fixed bone lengths."""

import numpy as np
from articulated import chain, swings
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.paper_2014.fixed_lengths import Observed, posed, rotations
from kinetree.tasks.numerics.structure.articulated_fit import placed

BODY = chain((-2.0, 2.0), swings(16, 3, degrees=40.0))
PARENTS = np.array([-1, 0, 0])


def test_rotations_are_those_of_the_part_and_stay_where_nothing_is_seen():
    x = BODY.x.copy()
    vertices = BODY.label == 2
    np.testing.assert_allclose(rotations(BODY.V, x, vertices), BODY.R[:, 2], atol=1e-9)
    x[5:] = np.nan
    np.testing.assert_allclose(rotations(BODY.V, x, vertices)[5:], np.broadcast_to(BODY.R[4, 2], (11, 3, 3)), atol=1e-9)


def about_random_axes(degrees, shape):
    """(*shape, 3, 3) rotations by so many degrees."""
    axis = np.random.default_rng(1).normal(size=(*shape, 3))
    return (
        Rotation.from_rotvec((np.deg2rad(degrees) * axis / np.linalg.norm(axis, axis=-1, keepdims=True)).reshape(-1, 3))
        .as_matrix()
        .reshape(*shape, 3, 3)
    )


def fixed(noise=0.0, turned=0.0, surface=1.0):
    """The chain with its middle as root: nodes are the middle, the low and the high part."""
    order = [1, 0, 2]
    joints = np.array([[0, 0, 0], [0, 0, -2.0], [0, 0, 2.0]])
    R, t = BODY.R[:, order], BODY.t[:, order]
    X = np.einsum("txy,ny->tnx", R[:, 0], joints) + t[:, :1]
    X = X + np.random.default_rng(0).normal(0, noise, X.shape)
    R = R @ about_random_axes(turned, R.shape[:2])
    leaf = np.array([np.argmin(BODY.V[:, 2]), np.argmax(BODY.V[:, 2])])
    node = np.argsort(order)[BODY.label]
    body = posed(BODY.V, BODY.x, node, PARENTS, Observed(X, R, BODY.x[:, leaf]), joints[0], np.array([1, 2]), surface)
    return body, X, leaf


def test_lengths_that_are_fixed_already_are_left_and_fit_exactly():
    body, X, leaf = fixed()
    np.testing.assert_allclose(body.positions, X, atol=1e-6)
    np.testing.assert_allclose(body.leaf_positions, BODY.x[:, leaf], atol=1e-6)
    assert body.drift.max() < 1e-6


def test_lengths_are_equal_in_all_frames_however_joints_shake():
    body, _, _ = fixed(noise=0.1)
    length = np.linalg.norm(body.positions[:, 1:] - body.positions[:, :1], axis=2)
    assert np.ptp(length, axis=0).max() < 1e-9
    np.testing.assert_allclose(placed(body.motion, PARENTS), body.positions)
    assert 0.01 < body.drift.max() < 0.3


def test_joints_of_fixed_lengths_are_met_however_wrong_the_rotations_are_that_the_surface_showed():
    for surface in (1.0, 0.01):
        body, _, _ = fixed(turned=50.0, surface=surface)
        assert body.drift.max() < 0.35, f"{surface}: joints of a tube of length 10 and radius 1"


def test_less_weight_on_the_surface_brings_joints_no_farther_from_where_they_are_seen():
    drift = [np.sqrt((fixed(noise=0.3, turned=50.0, surface=s)[0].drift ** 2).mean()) for s in (10.0, 1.0, 0.01)]
    assert drift[0] >= drift[1] >= drift[2]
