"""Prescribed anatomical angles come back with their signs, on either side."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.results.joint_angles import joint_angles

NAMES = ["pelvis", *(f"{s}_{side}" for side in "lr" for s in ("hip", "knee", "ankle", "foot_end")),
         *(f"{s}_{side}" for side in "lr" for s in ("shoulder", "elbow", "hand_end"))]  # fmt: skip
PARENTS = [-1, 0, 1, 2, 3, 0, 5, 6, 7, 0, 9, 10, 0, 12, 13]
FRONT, UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])


def standing():
    """(joint, xyz) x ahead, y up, z to the right; arms and legs hang, feet point ahead."""
    places = {"pelvis": (0, 9, 0), "hip": (0, 8.5, 1), "knee": (0, 4.5, 1), "ankle": (0, 0.5, 1), "foot_end": (2, 0.5, 1),
              "shoulder": (0, 14, 2), "elbow": (0, 11, 2), "hand_end": (0, 8, 2)}  # fmt: skip
    rows = [np.array(places[n.removesuffix("_l").removesuffix("_r")], float) for n in NAMES]
    return np.array([row * (1, 1, -1) if n.endswith("_l") else row for row, n in zip(rows, NAMES, strict=True)])


def angles(turns, rest=None, turned=None):
    """What is found where joints turn against their parents about axes of space; `turned` rotates everything."""
    rest, R = standing() if rest is None else rest, np.empty((2, len(NAMES), 3, 3))
    for j, (name, p) in enumerate(zip(NAMES, PARENTS, strict=True)):
        own = Rotation.from_rotvec(np.radians(turns.get(name, (0, 0, 0)))).as_matrix()
        before = np.eye(3) if p < 0 else R[1, p]
        R[0, j], R[1, j] = np.eye(3), before @ own
    Q = np.eye(3) if turned is None else turned
    return joint_angles(NAMES, PARENTS, rest @ Q.T, places(PARENTS, rest, R) @ Q.T, Q @ R @ Q.T, Q @ FRONT, Q @ UP).degrees


def places(parents, rest, R):
    """(frame, joint, xyz) where rotations bring the joints of a tree whose root stays."""
    X = np.tile(rest, (len(R), 1, 1))
    for j, p in enumerate(parents):
        if p >= 0:
            X[:, j] = X[:, p] + np.einsum("tyx,x->ty", R[:, p], rest[j] - rest[p])
    return X


@pytest.mark.parametrize("side", ["l", "r"])
@pytest.mark.parametrize(
    ("joint", "turn", "angle", "expected"),
    [
        ("hip", (0, 0, 30), "flexion", 30),  # the knee goes ahead
        ("hip", (0, 0, -20), "flexion", -20),
        ("hip", (25, 0, 0), "adduction", 25),  # of a right leg, the knee goes to the left
        ("hip", (0, 15, 0), "internal_rotation", 15),
        ("knee", (0, 0, -60), "flexion", 60),  # the foot goes back
        ("ankle", (0, 0, 12), "dorsiflexion", 12),
        ("ankle", (10, 0, 0), "inversion", 10),
        ("shoulder", (-40, 0, 0), "elevation", 40),
        ("elbow", (0, 0, 70), "flexion", 70),
        ("elbow", (0, 35, 0), "pronation", 35),
    ],
)
def test_one_turn_is_one_angle_and_the_others_stay(side, joint, turn, angle, expected):
    mirrored = turn if side == "r" else (-turn[0], -turn[1], turn[2])
    result = angles({f"{joint}_{side}": mirrored})
    for name, values in result.items():
        if name == f"{joint}_{side}.{angle}":
            np.testing.assert_allclose(values[1] - values[0], expected, atol=1e-9)
        elif not name.startswith("shoulder"):  # whose plane is open while the arm hangs
            np.testing.assert_allclose(values, 0.0, atol=1e-9)


@pytest.mark.parametrize(("turn", "plane"), [((-50, 0, 0), 0), ((0, 0, 50), 90), ((0, 0, -50), -90)])
def test_arm_is_raised_sideways_ahead_or_back(turn, plane):
    result = angles({"shoulder_r": turn})
    np.testing.assert_allclose(result["shoulder_r.plane_of_elevation"][1], plane, atol=1e-9)
    np.testing.assert_allclose(result["shoulder_r.elevation"][1], 50, atol=1e-9)


def test_three_angles_of_a_hip_are_those_of_flexion_then_adduction_then_rotation():
    R = Rotation.from_euler("ZXY", [35, -20, 10], degrees=True)
    result = angles({"hip_r": np.degrees(R.as_rotvec())})
    np.testing.assert_allclose([result[f"hip_r.{a}"][1] for a in ("flexion", "adduction", "internal_rotation")], [35, -20, 10])


def test_angles_do_not_depend_on_where_the_body_stands_and_faces():
    turned = Rotation.random(random_state=3).as_matrix()
    turns = {"hip_l": (10, 20, 30), "knee_r": (3, 0, -50), "shoulder_l": (40, 5, 30), "elbow_r": (0, 20, 60)}
    straight, other = angles(turns), angles(turns, turned=turned)
    assert list(straight) == list(other)
    assert len(straight) == 30
    for name in straight:
        if not name.startswith("shoulder_r"):  # it hangs: its plane is open
            np.testing.assert_allclose(other[name][1], straight[name][1], atol=1e-6)


def test_reference_pose_with_a_raised_knee_has_its_angles_already():
    rest = standing()
    lift = Rotation.from_rotvec([0, 0, np.radians(40)]).as_matrix()
    leg = [NAMES.index(f"{n}_r") for n in ("knee", "ankle", "foot_end")]
    hip = rest[NAMES.index("hip_r")]
    rest[leg] = hip + (rest[leg] - hip) @ lift.T
    result = angles({}, rest)
    np.testing.assert_allclose(result["hip_r.flexion"], 40, atol=1e-9)
    np.testing.assert_allclose(result["knee_r.flexion"], 0, atol=1e-9)


def test_joint_whose_segment_has_no_end_has_no_angles():
    result = joint_angles(
        ["pelvis", "hip_r"], [-1, 0], np.zeros((2, 3)), np.zeros((1, 2, 3)), np.tile(np.eye(3), (1, 2, 1, 1)), FRONT, UP
    )
    assert (result.degrees, result.rotation_seen) == ({}, {})


def test_hips_are_measured_from_the_bony_pelvis_and_not_from_a_surface_that_follows_the_thighs():
    names, parents = [*NAMES, "chest"], [*PARENTS, 0]
    rest = np.vstack([standing(), [0, 12, 0]])
    flexed = Rotation.from_euler("z", 60, degrees=True).as_matrix()
    R = np.tile(np.eye(3), (2, len(names), 1, 1))
    for name in ("hip_l", "knee_l", "ankle_l", "hip_r", "knee_r", "ankle_r"):
        R[1, names.index(name)] = flexed
    X = places(parents, rest, R)
    R[1, 0] = Rotation.from_euler("z", 20, degrees=True).as_matrix()  # a third of the thighs' turning, in place
    result = joint_angles(names, parents, rest, X, R, FRONT, UP).degrees
    for side in "lr":
        np.testing.assert_allclose(result[f"hip_{side}.flexion"], [0, 60], atol=1e-9)
    leaning = joint_angles(
        NAMES, PARENTS, rest[:-1], X[:, :-1], R[:, :-1], FRONT, UP
    ).degrees  # no spine: the surface is all there is
    np.testing.assert_allclose(leaning["hip_r.flexion"], [0, 40], atol=1e-9)


BENT = {"elbow_l": (0, 0, 70), "elbow_r": (0, 0, 70), "knee_l": (0, 0, -60), "knee_r": (0, 0, -60)}
"""Rotation vectors of joints that are bent, degrees."""


@pytest.mark.parametrize("side", ["l", "r"])
@pytest.mark.parametrize(("joint", "beyond"), [("hip", "knee"), ("shoulder", "elbow")])
def test_turn_of_a_segment_is_that_of_the_bend_beyond_it_whatever_its_surface_does(joint, beyond, side):
    """The segment turns inwards by 25°; its surface stays behind by all of that, but the places of joints tell."""
    mirror = 1 if side == "r" else -1
    raised = Rotation.from_euler("x", -40 * mirror if joint == "shoulder" else 0, degrees=True).as_matrix()
    turn = Rotation.from_rotvec(np.radians([[0, 0, 0], [0, 25 * mirror, 0]])).as_matrix()
    bend = Rotation.from_rotvec(np.radians(BENT[f"{beyond}_{side}"])).as_matrix()
    at = {name: j for j, name in enumerate(NAMES)}
    R = np.tile(np.eye(3), (2, len(NAMES), 1, 1))
    R[:, at[f"{joint}_{side}"]] = raised @ turn
    for name in ("knee", "ankle", "foot_end") if joint == "hip" else ("elbow", "hand_end"):
        R[:, at[f"{name}_{side}"]] = raised @ turn @ bend
    X = places(PARENTS, standing(), R)
    R[:, at[f"{joint}_{side}"]] = raised
    result = joint_angles(NAMES, PARENTS, standing(), X, R, FRONT, UP)
    rotation = result.degrees[f"{joint}_{side}.internal_rotation"]
    np.testing.assert_allclose((rotation[1] - rotation[0] + 180) % 360 - 180, 25, atol=1e-6)
    np.testing.assert_allclose(result.degrees[f"{beyond}_{side}.flexion"], abs(BENT[f"{beyond}_{side}"][2]), atol=1e-6)
    assert result.rotation_seen[f"{joint}_{side}"].all()


def test_pronation_is_that_of_the_hand_without_its_flexion():
    names = [*NAMES, "wrist_r"]
    parents = [*PARENTS, NAMES.index("elbow_r")]
    rest = np.vstack([standing(), [0, 8.5, 2]])
    R = np.tile(np.eye(3), (3, len(names), 1, 1))
    pronated = Rotation.from_euler("y", 40, degrees=True)
    R[1, -1] = pronated.as_matrix()  # the hand alone has turned; the surface of the forearm stayed
    R[2, -1] = (pronated * Rotation.from_euler("z", 50, degrees=True)).as_matrix()
    result = joint_angles(names, parents, rest, places(parents, rest, R), R, FRONT, UP)
    np.testing.assert_allclose(result.degrees["elbow_r.pronation"], [0, 40, 40], atol=1e-6)
    assert result.rotation_seen["elbow_r"].all()
    still = joint_angles(names, parents, rest, places(parents, rest, R), R, FRONT, UP, still={"wrist_r"})
    assert not still.rotation_seen["elbow_r"].any(), "a wrist at which no turn was measured moves as the forearm"


def test_straight_limbs_do_not_show_how_they_are_turned():
    result = joint_angles(
        NAMES, PARENTS, standing(), np.tile(standing(), (2, 1, 1)), np.tile(np.eye(3), (2, len(NAMES), 1, 1)), FRONT, UP
    )
    assert {name: is_seen.tolist() for name, is_seen in result.rotation_seen.items()} == {
        **{f"{j}_{s}": [False, False] for s in "lr" for j in ("hip", "shoulder", "elbow")},
        **{f"knee_{s}": [True, True] for s in "lr"},  # by the feet
    }
