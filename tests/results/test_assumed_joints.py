"""Joints that are assumed, from the task to the files, and that they count nowhere."""

import json

import networkx as nx
import numpy as np
import pytest
import yaml
from results.gltf_reader import Glb as Read
from results.rigged_bodies import bars_of, skeleton_of, skinned, without_joint
from scipy.spatial.transform import Rotation
from walkers import FIGURES

from kinetree.pipeline import views
from kinetree.schemas.results.assumed_joints import AssumedJoint, AssumedJoints, AssumedJointsParams
from kinetree.schemas.results.bvh import BvhParams
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.glb import GlbParams
from kinetree.schemas.results.skeleton_json import Document
from kinetree.schemas.results.usd import UsdParams
from kinetree.schemas.structure.joint_names import JointNames, JointNamesParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks import METHODS
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.results.assumed_joints import assumed_joints
from kinetree.tasks.results.bvh import bvh
from kinetree.tasks.results.formats.assumed import with_assumed
from kinetree.tasks.results.glb import glb
from kinetree.tasks.results.skeleton_json import skeleton_json
from kinetree.tasks.results.usd import usd
from kinetree.tasks.structure.joint_names import joint_names

Z_UP = UpDirection(up="z", confidence=0.9)
ADD = AssumedJointsParams(add=True)


def stiff_legged(bend=0.0):
    """The figure of a person whose left knee never turns, and is bent by so many degrees."""
    described = yaml.safe_load((FIGURES / "human.yaml").read_text("utf-8"))
    del described["motions"]["walk"]["knee_l"]
    at = {joint["name"]: np.array(joint["position"], float) for joint in described["joints"]}
    turn = Rotation.from_euler("x", bend, degrees=True)
    for joint in described["joints"]:
        if joint["name"] in ("ankle_l", "heel_l", "toe_l"):
            joint["position"] = (at["knee_l"] + turn.apply(at[joint["name"]] - at["knee_l"])).tolist()
    return Figure.of(described)


@pytest.fixture(scope="module")
def true():
    """A person who walks with the left knee straight."""
    return skeleton_of(Body.of(stiff_legged(), frames=12, fps=10.0, vertices=600, connectivity="fixed", motion="walk"))


@pytest.fixture(scope="module")
def body(true):
    """The same without that knee, as a run finds it."""
    skeleton = without_joint(true, "knee_l")
    return CompleteSkeleton(**{name: getattr(skeleton, name) for name in Skeleton.model_fields}, interpolated=())


@pytest.fixture(scope="module")
def names(body):
    return joint_names(body, Z_UP, JointNamesParams())


@pytest.fixture(scope="module")
def knee(body, names):
    return assumed_joints(body, names, ADD)


@pytest.fixture(scope="module")
def rig(body, names, knee):
    return with_assumed(body, names, knee)


def test_nothing_is_assumed_unless_it_is_asked_for(body, names, knee):
    assert assumed_joints(body, names, AssumedJointsParams()).joints == ()
    assert [(joint.name, joint.anatomy, joint.source) for joint in knee.joints] == [("knee_l", "knee_l", "mirror")]
    assert body.parents[knee.joints[0].child] == names.anatomy.index("hip_l")


@pytest.mark.parametrize(
    ("params", "name"),
    [
        ({"style": "mixamo"}, "mixamorig:LeftLeg"),
        ({"side_suffixes": (".L", ".R")}, "knee.L"),
        ({"rename": {"knee_l": "bend"}}, "bend"),
        ({"rename": {"knee_l": "pelvis"}}, "pelvis_2"),
    ],
)
def test_its_name_is_spelled_as_the_others_are_and_is_none_of_theirs(body, params, name):
    offered = assumed_joints(body, joint_names(body, Z_UP, JointNamesParams(**params)), ADD)
    assert [joint.name for joint in offered.joints] == [name]


def test_it_is_near_the_true_knee_in_every_frame_and_says_that_nothing_is_known(true, rig):
    (at,) = rig.assumed
    away = np.linalg.norm(rig.skeleton.positions[:, at] - true.positions[:, true.names.index("knee_l")], axis=1)
    assert away.max() < 0.05 * true.lengths[true.names.index("knee_l")]
    assert rig.skeleton.confidence[:, at].max() == rig.skeleton.degrees[at] == rig.skeleton.support[at] == 0


def test_the_motion_and_the_surface_stay_as_they_were_found(body, rig):
    s, t = rig.skeleton, len(rig.skeleton.names)
    assert t == len(body.names) + 1
    stay = [j for j in range(t) if j not in rig.assumed]
    np.testing.assert_array_equal(s.positions[:, stay], body.positions)
    np.testing.assert_array_equal(s.rotation[:, stay], body.rotation)
    for j, p in enumerate(s.parents):
        assert p < j
        if p >= 0:
            expected = s.positions[:, p] + s.rotation[:, p] @ (s.rest[j] - s.rest[p])
            np.testing.assert_allclose(s.positions[:, j], expected, atol=1e-6)
    np.testing.assert_allclose(skinned(s), skinned(body), atol=1e-9)
    np.testing.assert_allclose(s.weight.sum(axis=1), 1.0)
    assert (np.diff(s.weight, axis=1) <= 0.0).all()
    assert not np.isin(s.label, list(rig.assumed)).any()


def test_whoever_bends_it_moves_the_shank_and_the_foot_and_nothing_else(true, rig):
    """The vertices that follow the true rig's knee, or what hangs on it, are those that follow the assumed one."""
    s, (at,) = rig.skeleton, rig.assumed
    below = [name in ("knee_l", "ankle_l", "heel_l", "toe_l") for name in true.names]
    moved = [j == at or s.parents[j] == at or s.parents[s.parents[j]] == at for j in range(len(s.names))]
    expected = np.sum(true.weight * np.array(below)[true.influence], axis=1)
    share = np.sum(s.weight * np.array(moved)[s.influence], axis=1)
    assert np.abs(share - expected).mean() < 0.02
    assert ((share > 0.5) == (expected > 0.5)).mean() > 0.98


@pytest.mark.parametrize("bend", [0, 45, 80])
def test_it_lies_in_the_middle_of_a_limb_that_is_bent(bend):
    true = skeleton_of(Body.of(stiff_legged(bend), frames=3, fps=10.0, vertices=1500, connectivity="fixed", motion="walk"))
    skeleton = without_joint(true, "knee_l")
    body = CompleteSkeleton(**{name: getattr(skeleton, name) for name in Skeleton.model_fields}, interpolated=())
    (knee,) = assumed_joints(body, joint_names(body, Z_UP, JointNamesParams()), ADD).joints
    off = np.linalg.norm(np.array(knee.place) - true.rest[true.names.index("knee_l")])
    assert off < 0.03 * np.ptp(true.vertices[:, 2])


def test_several_joints_of_one_bone_follow_each_other(body, names):
    child = names.anatomy.index("ankle_l")
    pair = [
        AssumedJoint(name=n, anatomy=n, child=child, share=s, place=(0, 0, 100 * s), source="mirror")
        for n, s in (("b", 0.75), ("a", 0.25))
    ]
    rig = with_assumed(body, names, AssumedJoints(joints=tuple(pair)))
    a, b = (rig.names.names.index(n) for n in "ab")
    ankle = rig.names.anatomy.index("ankle_l")
    assert (rig.skeleton.parents[ankle], rig.skeleton.parents[b], rig.assumed) == (b, a, {a, b})
    assert rig.names.names[rig.skeleton.parents[a]] == "hip_l"


def test_skeleton_json_says_that_it_is_assumed(body, names, knee):
    content = views.files(skeleton_json(body, names, Z_UP, bars_of(body), knee), ())["skeleton.json"]
    joints = Document.model_validate_json(content).joints
    assert [joint.name for joint in joints if joint.kind == "assumed"] == ["knee_l"]
    (ankle,) = [joint for joint in joints if joint.anatomy == "ankle_l"]
    assert joints[ankle.parent].kind == "assumed"
    kinds = [joint.kind for joint in joints if joint.kind != "assumed"]
    assert kinds == list(body.kinds)
    confidence = np.array(json.loads(content)["confidence"])
    assert confidence[:, [joint.kind == "assumed" for joint in joints]].max() == 0
    assert [joint.error is None for joint in joints] == [joint.kind != "joint" for joint in joints]


def test_without_it_the_files_are_the_same_to_the_byte(body, names):
    nothing = assumed_joints(body, names, AssumedJointsParams())
    bars = bars_of(body)
    documents = (skeleton_json(body, names, Z_UP, bars, nothing), skeleton_json(body, names, Z_UP, bars))
    assert documents[0].content.tobytes() == documents[1].content.tobytes()
    glbs = (glb(body, names, Z_UP, GlbParams(), assumed_joints=nothing), glb(body, names, Z_UP, GlbParams()))
    assert glbs[0].content.tobytes() == glbs[1].content.tobytes()


@pytest.mark.parametrize("rest", ["reference", "t"])
def test_glb_has_a_joint_to_bend_and_moves_as_before(body, names, knee, rest):
    glbs = [glb(body, names, Z_UP, GlbParams(rest=rest), assumed_joints=each) for each in (AssumedJoints(), knee)]
    before, after = (Read(views.files(each, ())["skeleton.glb"]) for each in glbs)
    assert set(after.names) - set(before.names) == {"knee_l"}
    ankle, knee_node = (after.joints[after.names.index(n)] for n in ("ankle_l", "knee_l"))
    assert after.parent[ankle] == knee_node
    for name in before.names:
        a, b = before.pose(5)[before.names.index(name)], after.pose(5)[after.names.index(name)]
        np.testing.assert_allclose(a[:, 3], b[:, 3], atol=1e-5)


def test_bvh_has_it_between_hip_and_ankle(body, names, knee):
    lines = views.files(bvh(body, names, Z_UP, BvhParams(), knee), ())["skeleton.bvh"].decode().split("MOTION")[0].split("\n")
    order = [line.split()[1] for line in lines if line.strip().startswith(("ROOT", "JOINT"))]
    assert order.index("ankle_l") == order.index("knee_l") + 1 == order.index("hip_l") + 2


def test_usd_has_it_between_hip_and_ankle(body, names, knee):
    pytest.importorskip("pxr", reason="pip install 'kinetree[usd]' brings Pixar's library")
    text = views.files(usd(body, names, Z_UP, UsdParams(), knee), ())["skeleton.usda"].decode()
    assert "hip_l/knee_l/ankle_l" in text


def test_shown_skeleton_marks_it_and_the_run_names_it(body, names, knee):
    others = {JointNames: names, AssumedJoints: knee}
    before, lines = views.text(body, {JointNames: names}.get), views.text(body, others.get)
    assert lines[:-1] == before
    assert lines[-1].startswith("assumed, not found: left knee, at ")
    assert lines[-1].endswith("from left hip (hip_l) to left ankle (ankle_l), as on the other side")
    assert views.remarks(knee) == ("assumed in files, not found: knee_l",)
    assert views.remarks(AssumedJoints()) == ()


@pytest.mark.parametrize("method", METHODS)
def test_no_comparison_and_no_verdict_reads_it(method):
    graph = METHODS[method]
    edges = [(read.name, task.name) for task in graph.tasks for read in graph.before(task)]
    shown = {"skeleton_json", "bvh", "glb", "blender", "usd", "played_body", "report"}
    assert nx.descendants(nx.DiGraph(edges), "assumed_joints") <= shown
