"""Laws of directions of a moving body."""

import numpy as np
import pytest
from walkers import turned, walker

from kinetree.tasks.numerics.structure.limb_motion import across_pair, along_trunk, horizontal, in_rest, middle
from kinetree.tasks.numerics.structure.limbs import limbs


@pytest.fixture(scope="module")
def person():
    body = walker("human")
    by_tip = {body.names[limb.joints[0]]: limb for limb in limbs(body.motion.rest, body.motion.parents)}
    return body.motion, tuple(by_tip[x] for x in ("toe_l", "toe_r")), tuple(by_tip[x] for x in ("hand_l", "hand_r"))


def test_the_trunk_of_a_walker_points_up_and_is_of_length_one(person):
    motion, legs, arms = person
    along = along_trunk(motion, legs, arms)
    np.testing.assert_allclose(np.linalg.norm(along, axis=1), 1.0)
    assert (along @ motion.up > 0.9).all()
    np.testing.assert_allclose(along_trunk(motion, arms, legs), -along)


def test_a_pair_in_the_other_order_points_the_other_way(person):
    motion, legs, _ = person
    np.testing.assert_allclose(across_pair(motion, *legs), -across_pair(motion, *legs[::-1]))
    np.testing.assert_allclose(middle(motion, legs), middle(motion, legs[::-1]))


def test_directions_turn_with_the_body(person):
    motion, legs, arms = person
    Q = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    Q *= np.linalg.det(Q)
    there = turned(motion, Q, 0.01)
    np.testing.assert_allclose(along_trunk(there, legs, arms), along_trunk(motion, legs, arms) @ Q.T, atol=1e-9)


def test_a_direction_that_a_part_carries_is_the_same_in_the_reference_pose():
    body = walker("human").motion
    fixed = np.array([0.3, -0.5, 0.8])
    carried = np.einsum("txy,y->tx", body.R[:, 0], fixed)
    np.testing.assert_allclose(in_rest(body, 0, carried), fixed)


def test_the_horizontal_part_has_length_one_and_none_is_left_as_it_is():
    up = np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(horizontal(np.array([3.0, 4.0, 7.0]), up), [0.6, 0.8, 0.0])
    np.testing.assert_allclose(horizontal(up, up), up)
