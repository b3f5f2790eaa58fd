"""Laws of naming joints after the anatomy."""

import numpy as np
import pytest
from walkers import HUMAN, QUADRUPED, walker, without

from kinetree.tasks.numerics.structure.anatomical_names import anatomical_names
from kinetree.tasks.numerics.structure.anatomy import anatomy


def named(body):
    return [name and name.text for name in anatomical_names(body.motion, body.ends, anatomy(body.motion))]


def wrong(body, known):
    """True name and given name of all joints that are not called what they are."""
    pairs = [(known.get(true, true), name) for true, name in zip(body.names, named(body), strict=True)]
    return [(true, name) for true, name in pairs if true is not None and true != name]


@pytest.mark.parametrize("motion", ["walk", "wave", "squat"])
@pytest.mark.parametrize("seed", range(3))
def test_every_joint_of_a_person_has_its_name(motion, seed):
    assert wrong(walker("human", motion, seed), HUMAN) == []


@pytest.mark.parametrize("motion", ["walk", "look"])
@pytest.mark.parametrize("seed", range(3))
def test_every_joint_of_an_animal_has_its_name(motion, seed):
    assert wrong(walker("quadruped", motion, seed), QUADRUPED) == []


@pytest.mark.parametrize(
    "name", ["spine", "chest", "neck", "head", "shoulder_l", "elbow_r", "wrist_l", "hip_r", "knee_l", "ankle_r"]
)
def test_a_joint_that_was_not_found_does_not_shift_the_names_of_the_others(name):
    assert wrong(without(walker("human"), name, "heel_l", "heel_r"), HUMAN) == []


def test_names_are_unique():
    for figure in ("human", "quadruped"):
        names = [name for name in named(walker(figure)) if name is not None]
        assert len(set(names)) == len(names)


def test_root_is_the_torso_where_the_legs_hang_elsewhere():
    body = walker("human")
    parents = body.motion.parents.copy()
    chest, spine, hips = (body.names.index(n) for n in ("chest", "spine", "hips"))
    parents[[chest, spine, hips]] = -1, chest, spine
    order = np.array([chest, spine, hips, *[j for j in range(len(parents)) if j not in (chest, spine, hips)]])
    number = np.argsort(order)
    motion = body.motion._replace(
        rest=body.motion.rest[order], X=body.motion.X[:, order], R=body.motion.R[:, order],
        parents=np.array([-1 if parents[j] < 0 else number[parents[j]] for j in order]),
    )  # fmt: skip
    turned = body._replace(motion=motion, ends=body.ends[order], names=[body.names[j] for j in order])
    names = dict(zip(turned.names, named(turned), strict=True))
    assert names["chest"] == "torso"
    assert (names["knee_l"], names["elbow_r"]) == ("knee_l", "elbow_r")
