"""Laws of joints that are assumed: a body without one of its joints has it back where it was, and none that it did not lose."""

import numpy as np
import pytest
import yaml
from walkers import FIGURES, HUMAN, moved, walker, without

from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.results.assumed_joints import assumed_joints
from kinetree.tasks.numerics.structure.anatomical_names import anatomical_names
from kinetree.tasks.numerics.structure.anatomy import anatomy

HEELS = ("heel_l", "heel_r")


def recognised(body):
    place_of = anatomy(body.motion)
    return place_of.topology, [name.text if name else "" for name in anatomical_names(body.motion, body.ends, place_of)]


def assumed(body):
    topology, names = recognised(body)
    return assumed_joints(body.motion.rest, body.motion.parents.tolist(), names, topology)


def places(body):
    """Where each assumed joint lies in the reference pose, by what it is."""
    rest, parents = body.motion.rest, body.motion.parents
    return {
        joint.named.text: (1 - joint.share) * rest[parents[joint.child]] + joint.share * rest[joint.child]
        for joint in assumed(body)
    }


def error(whole, place_of, name):
    """Distance of an assumed joint from the true one, share of the body's height."""
    true = whole.motion.rest[[HUMAN.get(n, n) for n in whole.names].index(name)]
    return np.linalg.norm(place_of[name] - true) / np.ptp(whole.motion.rest[:, 2])


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ["knee_l", "knee_r", "elbow_l", "wrist_r"])
def test_a_joint_of_a_person_lies_where_the_other_side_has_it(name, seed):
    whole = walker("human", "walk", seed)
    place_of = places(without(whole, name, *HEELS))
    assert list(place_of) == [name]
    assert error(whole, place_of, name) < 0.02


def test_a_knee_held_straight_over_the_sequence_is_assumed_near_the_true_one():
    described = yaml.safe_load((FIGURES / "human.yaml").read_text("utf-8"))
    del described["motions"]["walk"]["knee_l"]
    whole = moved(Figure.of(described), "walk")
    body = without(whole, "knee_l", *HEELS)
    (knee,) = assumed(body)
    assert (knee.named.text, knee.source) == ("knee_l", "mirror")
    hip, end = body.motion.X[:, body.motion.parents[knee.child]], body.motion.X[:, knee.child]
    away = np.linalg.norm((1 - knee.share) * hip + knee.share * end - whole.motion.X[:, whole.names.index("knee_l")], axis=1)
    thigh = np.linalg.norm(np.diff(whole.motion.rest[[whole.names.index(n) for n in ("hip_l", "knee_l")]], axis=0))
    assert away.max() < 0.05 * thigh


@pytest.mark.parametrize("pair", ["knee", "elbow", "wrist"])
def test_joints_that_neither_side_has_lie_by_the_proportions_of_people(pair):
    whole = walker("human", "walk")
    body = without(whole, f"{pair}_l", f"{pair}_r", *HEELS)
    assert {joint.source for joint in assumed(body)} == {"proportions"}
    place_of = places(body)
    assert sorted(place_of) == [f"{pair}_l", f"{pair}_r"]
    assert max(error(whole, place_of, name) for name in place_of) < 0.05


def test_two_joints_of_one_bone_stand_in_their_order():
    joints = assumed(without(walker("human", "walk"), "knee_l", "ankle_l", *HEELS))
    assert [joint.named.text for joint in joints] == ["knee_l", "ankle_l"]
    assert joints[0].child == joints[1].child
    assert 0 < joints[0].share < joints[1].share < 1


def test_a_neck_stands_between_the_chest_and_the_head():
    whole = walker("human", "walk")
    place_of = places(without(whole, "neck", "head", *HEELS))
    assert list(place_of) == ["neck"]
    assert error(whole, place_of, "neck") < 0.05


def test_animals_have_joints_of_the_other_side_and_no_proportions_of_people():
    whole = walker("quadruped", "walk")
    (joint,) = assumed(without(whole, "stifle_l"))
    hip, knee, ankle = (whole.motion.rest[whole.names.index(name)] for name in ("hip_r", "stifle_r", "hock_r"))
    thigh, shank = np.linalg.norm(knee - hip), np.linalg.norm(ankle - knee)
    assert (joint.named.text, joint.source) == ("hind_knee_l", "mirror")
    assert joint.share == pytest.approx(thigh / (thigh + shank))
    assert assumed(without(whole, "stifle_l", "stifle_r")) == []


@pytest.mark.parametrize("figure", ["human", "quadruped"])
def test_a_whole_body_lacks_nothing(figure):
    assert assumed(walker(figure)) == []


def test_nothing_is_assumed_of_other_bodies():
    body = without(walker("human"), "knee_l")
    _, names = recognised(body)
    assert assumed_joints(body.motion.rest, body.motion.parents.tolist(), names, "unknown") == []


def test_no_joint_is_assumed_where_one_without_a_name_was_found():
    body = walker("human")
    topology, names = recognised(body)
    names[names.index("knee_l")] = ""
    assert assumed_joints(body.motion.rest, body.motion.parents.tolist(), names, topology) == []


def test_a_joint_at_the_end_of_its_bone_is_that_end():
    rest = np.array([[0, 0, 9.0], [1, 0, 9], [-1, 0, 9], [1, 0, 1], [-1, 0, 8.99], [-1, 0, 1]])
    names = ["pelvis", "hip_l", "hip_r", "ankle_l", "knee_r", "ankle_r"]
    assert assumed_joints(rest, [-1, 0, 0, 1, 2, 4], names, "human") == []
    rest[4, 2] = 5.0
    assert [joint.share for joint in assumed_joints(rest, [-1, 0, 0, 1, 2, 4], names, "human")] == [0.5]
