"""T-pose and A-pose of a generated person."""

import numpy as np
import pytest
from results.rigged_bodies import skeleton_of, skinned, spider
from walkers import shipped

from kinetree.schemas.structure.joint_names import JointNamesParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.results.formats.rest_pose import at_rest
from kinetree.tasks.structure.joint_names import joint_names


@pytest.fixture(scope="module")
def human():
    return skeleton_of(Body.of(shipped("human"), frames=6, fps=10.0, motion="wave", vertices=800, connectivity="fixed"))


def named(skeleton):
    return joint_names(skeleton, UpDirection(up="z", confidence=0.9), JointNamesParams())


def posed(skeleton, rest):
    return at_rest(skeleton, named(skeleton), "z", rest)


def direction(skeleton, a, b):
    d = skeleton.rest[skeleton.names.index(b)] - skeleton.rest[skeleton.names.index(a)]
    return d / np.linalg.norm(d)


@pytest.mark.parametrize(("rest", "degrees"), [("t", 0.0), ("a", 45.0)])
def test_limbs_have_the_directions_of_the_pose(human, rest, degrees):
    body, pose = posed(human, rest)
    front = named(human).front
    assert front @ [0, -1, 0] > 0.995
    arm = np.cos(np.radians(degrees)) * np.cross([0, 0, 1], front) - [0, 0, np.sin(np.radians(degrees))]
    assert pose == rest
    for a, b in (("shoulder_l", "elbow_l"), ("elbow_l", "wrist_l"), ("wrist_l", "hand_l")):
        np.testing.assert_allclose(direction(body, a, b), arm, atol=1e-6)
    np.testing.assert_allclose(direction(body, "hip_r", "knee_r"), [0, 0, -1], atol=1e-6)
    np.testing.assert_allclose(direction(body, "ankle_r", "toe_r"), front, atol=1e-6)
    np.testing.assert_allclose(body.lengths, human.lengths)


def test_motion_of_the_joints_is_the_same_and_that_of_the_skin_nearly(human):
    body, _ = posed(human, "t")
    np.testing.assert_array_equal(body.positions, human.positions)
    for j, p in enumerate(body.parents):
        if p >= 0:
            carried = body.positions[:, p] + (body.rotation[:, p] @ (body.rest[j] - body.rest[p]))
            np.testing.assert_allclose(carried, human.positions[:, j], atol=1e-6)
    off = np.linalg.norm(skinned(body) - skinned(human), axis=2)
    height = np.ptp(human.vertices[:, 2])
    assert np.median(off) < 0.001 * height
    assert off.max() < 0.05 * height


def test_other_bodies_stay_in_the_reference_pose():
    body = spider()
    assert posed(body, "t") == (body, "reference")
