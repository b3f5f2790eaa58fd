"""Names that people know, as a task: artifacts in, names out."""

import numpy as np
import pytest
from results.rigged_bodies import skeleton_of, spider
from walkers import HUMAN, QUADRUPED, shipped

from kinetree.pipeline import views
from kinetree.schemas.structure.joint_names import JointNamesParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.structure.joint_names import joint_names

Z_UP = UpDirection(up="z", confidence=0.9)


@pytest.fixture(scope="module")
def human():
    return skeleton_of(Body.of(shipped("human"), frames=12, fps=10.0, vertices=600, connectivity="fixed"))


def named(skeleton, **params):
    return joint_names(skeleton, Z_UP, JointNamesParams(**params))


def test_a_person_has_the_names_of_a_person(human):
    found = named(human)
    assert found.topology == "human"
    assert found.given == human.names
    pairs = zip(human.names, found.names, strict=True)
    assert [(true, name) for true, name in pairs if (known := HUMAN.get(true, true)) and known != name] == []
    assert found.front @ [0, -1, 0] > 0.9
    (remark,) = views.remarks(found)
    assert "a person" in remark


def test_style_sides_and_single_names_are_as_they_are_set(human):
    assert "mixamorig:LeftForeArm" in named(human, style="mixamo").names
    assert "elbow.L" in named(human, side_suffixes=(".L", ".R")).names
    found = named(human, style="vrm", rename={"leftLowerArm": "elbow", "chest": "ribs"})
    assert {"elbow", "ribs"} <= set(found.names)
    assert "elbow_l" in found.anatomy


def test_names_of_joints_that_are_not_there_are_told(human):
    renamed = {human.names[0]: "a", "elbow.L": "b", "mixamorig:LeftForeArm": "c"}
    (_, told) = views.remarks(named(human, style="mixamo", rename=renamed))
    assert told == "joint_names.rename: no joint that was found is called elbow.L"  # it is LeftForeArm in this style
    (_, told) = views.remarks(named(human, side_suffixes=(".L", ".R"), rename=renamed))
    assert told == "joint_names.rename: no joint that was found is called mixamorig:LeftForeArm"
    assert len(views.remarks(named(human, rename={human.names[1]: "a"}))) == 1
    (_, told) = views.remarks(named(human, rename={f"x{n}": "y" for n in range(9)}))
    assert told.endswith("is called x0, x1, x2, x3, x4 and 4 more")
    (told,) = views.remarks(named(human, style="none", rename={"elbow.L": "b"}))
    assert told.endswith("is called elbow.L")


def test_names_that_are_taken_are_numbered_and_told(human):
    found = named(human, rename={"pelvis": "elbow_l"})
    assert {"elbow_l", "elbow_l_2"} <= set(found.names)
    (_, told) = views.remarks(found)
    assert told == "joint_names.rename: a name that another joint has gets a number: elbow_l is elbow_l_2"


def test_names_that_files_cannot_hold_are_told(human):
    (_, told) = views.remarks(named(human, rename={"pelvis": "a b!?", "neck": "hals"}))
    assert told == "joint_names.rename: names in bvh, trc, c3d, usd, rignet are of a-z, A-Z, 0-9 and _: 'a b!?' is a_b__"
    assert len(views.remarks(named(human, style="mixamo"))) == 1  # which has a colon of its own


def test_no_style_leaves_the_names_of_the_skeleton(human):
    found = named(human, style="none")
    assert (found.names, found.topology) == (human.names, "unknown")


def test_front_that_is_set_decides_left_and_right(human):
    found, other = named(human), named(human, front="y")
    at = found.names.index("knee_l")
    assert other.names[at] == "knee_r"
    assert other.front_confidence == 1.0


def test_other_bodies_keep_their_names_and_nothing_is_said():
    found = named(spider())
    assert (found.names, found.topology) == (spider().names, "unknown")
    assert not found.front.any()
    assert views.remarks(found) == ()


def test_sides_that_are_not_certain_are_said(human):
    found = named(human).model_copy(update={"front_confidence": 0.2})
    assert "set joint_names.front" in views.remarks(found)[1]


def test_shown_names_are_those_of_the_skeleton_and_of_the_files(human):
    lines = views.text(named(human, style="mixamo"))
    assert any(line.split() == ["elbow_l", "mixamorig:LeftForeArm", "elbow_l"] for line in lines)
    assert len(lines) == len(human.names)


def test_animals_have_their_own_names_in_every_style():
    dog = skeleton_of(Body.of(shipped("quadruped"), frames=12, fps=10.0, vertices=600, connectivity="fixed"))
    found = named(dog, style="mixamo")
    assert found.topology == "quadruped"
    pairs = zip(dog.names, found.names, strict=True)
    assert [(true, name) for true, name in pairs if (known := QUADRUPED.get(true, true)) and known != name] == []
    assert np.linalg.norm(found.front) == pytest.approx(1.0)
