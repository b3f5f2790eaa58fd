"""Joints of several cuts: which are the same, where they are in the mean, how far apart."""

import numpy as np
import pytest
from limbs import rotation

from kinetree.tasks.numerics.structure.joint_consensus import JointMotion, joint_consensus, same_joints

FRAMES = 6
RIGID = np.stack([rotation((0.3, 0.8, 0.5), 0.2 * k) for k in range(FRAMES)])
SHIFT = np.outer(np.arange(FRAMES), [0.5, -0.2, 0.1])


def motion(joints: int) -> JointMotion:
    """Two parts that move as one at every joint."""
    R = np.tile(RIGID[:, None], (2, 1, joints, 1, 1))
    return JointMotion(R, np.tile(SHIFT[:, None], (2, 1, joints, 1)), np.ones((FRAMES, joints)))


def carried(rest: np.ndarray) -> np.ndarray:
    return np.einsum("txy,jy->tjx", RIGID, rest) + SHIFT[:, None]


def test_joints_are_the_mean_of_the_cuts_and_spread_is_their_distance_from_it() -> None:
    rest, by = np.array([[1.0, 2.0, 3.0], [4.0, 0.0, 0.0]]), np.array([[0.0, 0.02, 0.0], [0.0, 0.0, -0.01]])
    found = joint_consensus(rest, motion(2), [carried(rest + by), carried(rest - by)], size=1.0)
    assert found.rest == pytest.approx(rest)
    assert found.spread == pytest.approx(np.sqrt(2 / 3) * np.linalg.norm(by, axis=1))
    assert found.agreeing.tolist() == [3, 3]
    one = joint_consensus(rest, motion(2), [carried(rest + by)], size=1.0)
    assert one.rest == pytest.approx(rest + by / 2)


def test_a_joint_that_one_cut_alone_has_stays_and_its_spread_is_not_known() -> None:
    rest = np.array([[1.0, 2.0, 3.0], [4.0, 0.0, 0.0]])
    found = joint_consensus(rest, motion(2), [carried(rest[1:]), np.zeros((FRAMES, 0, 3))], size=1.0)
    assert found.rest == pytest.approx(rest)
    assert found.agreeing.tolist() == [1, 2]
    assert np.isnan(found.spread[0])
    assert found.spread[1] == pytest.approx(0.0, abs=1e-9)


def test_every_joint_has_at_most_one_partner_and_none_beyond_the_gate() -> None:
    X = np.zeros((FRAMES, 2, 3))
    X[:, 1, 0] = 1.0
    assert same_joints(X, X[:, [1]] + [0.1, 0.0, 0.0], 0.2) == [(1, 0)]
    assert same_joints(X, X[:, [1]] + [0.3, 0.0, 0.0], 0.2) == []
    assert same_joints(X[:, [0]], np.concatenate([X[:, [0]] + 0.05, X[:, [0]] + 0.01], axis=1), 0.2) == [(0, 1)]
