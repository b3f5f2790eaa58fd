"""Laws of recognising people and four-legged animals."""

import numpy as np
import pytest
from walkers import beast, moved, shipped, turned, walker

from kinetree.tasks.numerics.input.synth.trees import random_tree
from kinetree.tasks.numerics.structure.anatomy import anatomy

PEOPLE = [("human", motion, seed) for motion in ("walk", "wave", "squat") for seed in range(3)]
ANIMALS = [("quadruped", motion, seed) for motion in ("walk", "look") for seed in range(3)]


def tips(body, pair):
    return tuple(body.names[limb.joints[0]] for limb in pair)


@pytest.mark.parametrize(("name", "motion", "seed"), PEOPLE + ANIMALS)
def test_limbs_front_and_sides_are_those_that_were_generated(name, motion, seed):
    body = walker(name, motion, seed)
    found = anatomy(body.motion)
    assert found is not None
    assert found.topology == name
    ends = (("toe_l", "toe_r"), ("hand_l", "hand_r") if name == "human" else ("claw_l", "claw_r"))
    assert tuple(tips(body, pair) for pair in found.pairs) == ends
    assert body.names[found.head.joints[0]] == ("head_top" if name == "human" else "muzzle")
    assert (found.tail is None) == (name == "human")
    assert found.front @ [0, -1, 0] > 0.95
    assert found.certainty > 0.5


@pytest.mark.parametrize("kind", [("ears",), ("tusks",), ("horns", "nose"), ("ears", "trunk"), ("ears", "tusks", "trunk")])
@pytest.mark.parametrize("motion", ["walk", "look"])
def test_ears_horns_tusks_and_a_trunk_are_no_legs(kind, motion):
    for seed in range(2):
        body = moved(beast(*kind), motion, seed)
        found = anatomy(body.motion)
        assert found is not None
        assert found.topology == "quadruped"
        assert tuple(tips(body, pair) for pair in found.pairs) == (("toe_l", "toe_r"), ("claw_l", "claw_r"))
        assert body.names[found.tail.joints[0]] == "tail_tip"
        assert found.front @ [0, -1, 0] > 0.95
        assert found.certainty > 0.5


@pytest.mark.parametrize("name", ["human", "quadruped"])
def test_neither_coordinates_nor_unit_matter(name):
    body = walker(name)
    Q = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    Q *= np.linalg.det(Q)
    here, there = anatomy(body.motion), anatomy(turned(body.motion, Q, 0.01))
    assert there.pairs[0][0].joints == here.pairs[0][0].joints
    assert there.pairs[1][0].joints == here.pairs[1][0].joints
    assert there.confidence == pytest.approx(here.confidence)
    np.testing.assert_allclose(there.front, Q @ here.front, atol=1e-6)


@pytest.mark.parametrize("name", ["human", "quadruped"])
def test_left_and_right_change_in_a_mirror(name):
    body = walker(name)
    mirrored = anatomy(turned(body.motion, np.diag([-1.0, 1.0, 1.0])))
    assert [tips(body, pair)[0][-1] for pair in mirrored.pairs] == ["r", "r"]


@pytest.mark.parametrize("name", ["human", "quadruped"])
def test_front_that_is_said_goes_before_the_one_that_is_found(name):
    body = walker(name)
    found = anatomy(body.motion, front=np.array([0.0, 1.0, 0.0]))
    assert found.front @ [0, 1, 0] > 0.95
    assert found.certainty == 1.0
    if name == "human":
        assert tips(body, found.pairs[0]) == ("toe_r", "toe_l")


def test_a_person_whose_front_nothing_tells_is_not_certain():
    body = walker("human")
    flat = np.diag([1.0, 0.0, 1.0])
    still = body.motion._replace(
        rest=body.motion.rest @ flat,
        X=np.repeat(body.motion.rest[None] @ flat, 3, axis=0),
        R=np.tile(np.eye(3), (3, len(body.names), 1, 1)),
    )
    found = anatomy(still)
    assert found is not None
    assert found.certainty < 0.5


@pytest.mark.parametrize("name", ["snake", "starfish", "bird"])
def test_other_bodies_are_not_recognised(name):
    assert anatomy(moved(shipped(name)).motion) is None


def test_random_trees_are_not_recognised():
    known = [seed for seed in range(10) if anatomy(moved(random_tree(seed)).motion) is not None]
    assert known == []
