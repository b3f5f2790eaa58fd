"""Signed angles of a person's joints about anatomical axes, as the ISB recommends (Wu 2002, 2005; Grood, Suntay 1983).

Axes of a segment: x ahead, y up along it, z to the right. How a thigh or an upper arm is turned about its own length is told by
the plane in which the knee or elbow is bent, of a shank by the foot, of a forearm by the hand (`axial_rotation`); where nothing
tells, a segment is in the reference pose as little rotated from the one before it as its direction allows, and from there on
the rotations of the parts count. For the pelvis the places of the hips and of a joint of the spine do, since the surface around
the hips moves with the thighs. Signs are those of a right limb: left limbs are mirrored.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.results.axial_rotation import AxialTurn, turn_of_bend, turn_of_direction, turn_of_part, turned

MIRROR = np.diag([1.0, 1.0, -1.0])
"""Left to right, in the axes of a segment."""
DOWN, AHEAD = np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0])
TO_TRUNK = ("collar", "hip_base")
"""Stations between a limb and the trunk, which carry no segment of their own."""
SPINE = ("spine", "spine_1", "spine_2", "chest", "neck")
"""Stations above the pelvis, from below."""
LEVER = 0.9
"""Least distance of the hips to the joint of the spine that says how the pelvis leans, share of the distance between the hips.
Chosen on eight generated people; half as much again does as well."""


class _Joint(NamedTuple):
    """The stations at which its segment may end, the axis of the segment that points there, and names of the three angles."""

    ends: tuple[str, ...]
    along: Floats
    angles: tuple[str, str, str]


JOINTS: Mapping[str, _Joint] = {
    "hip": _Joint(("knee", "ankle", "foot_end"), DOWN, ("flexion", "adduction", "internal_rotation")),
    "knee": _Joint(("ankle", "foot_end"), DOWN, ("flexion", "adduction", "internal_rotation")),
    "ankle": _Joint(("toe", "foot_end"), AHEAD, ("dorsiflexion", "inversion", "internal_rotation")),
    "shoulder": _Joint(("elbow", "wrist", "hand_end"), DOWN, ("plane_of_elevation", "elevation", "internal_rotation")),
    "elbow": _Joint(("wrist", "hand_end"), DOWN, ("flexion", "adduction", "pronation")),
}
"""In the order in which segments follow each other."""


class JointAngles(NamedTuple):
    """Angles of named joints.

    degrees       : (frame,) by "joint.angle", such as knee_l.flexion
    rotation_seen : (frame,) by joint but the ankles: whether this frame shows its internal rotation or pronation
    """

    degrees: Mapping[str, Floats]
    rotation_seen: Mapping[str, Flags]


def joint_angles(
    anatomy: Sequence[str],
    parents: Sequence[int],
    rest: Floats,
    X: Floats,
    R: Floats,
    front: Floats,
    up: Floats,
    takes: Sequence[slice] | None = None,
    still: Collection[str] = (),
) -> JointAngles:
    """Three angles of each named joint: hip, knee, ankle and elbow by Z–X–Y, shoulder by Y–X–Y (thorax to humerus).

    anatomy   : (joint,) station and side, such as knee_l
    parents   : (joint,) −1 for the root
    rest      : (joint, xyz) joints in the reference pose
    X         : (frame, joint, xyz) joints in each frame
    R         : (frame, joint, 3, 3) from the reference pose to each frame
    front, up : (xyz,) of the body in the reference pose, unit vectors
    takes     : positions of the frames of each take; None takes all as one
    still     : names of joints at which no turn was measured: a wrist among them moves as the forearm, and says nothing of it
    returns   : flexion, adduction, internal rotation, dorsiflexion, inversion, pronation and elevation are positive; 0° of the
                plane of elevation is sideways, 90° ahead; pronation is against the reference pose
    """
    at = {name: j for j, name in enumerate(anatomy) if name}
    pelvis = _pelvis(at, rest, X, up)
    trunk = {"hip": _trunk(at, rest, front, up, "hip"), "shoulder": _trunk(at, rest, front, up, "shoulder")}
    frames: dict[int, Floats] = {}
    moving: dict[int, Floats] = {}
    angles: dict[str, Floats] = {}
    rotation_seen: dict[str, Flags] = {}
    for station, joint in JOINTS.items():
        for side in "lr":
            j = at.get(f"{station}_{side}")
            end = next((at[f"{e}_{side}"] for e in joint.ends if f"{e}_{side}" in at), None)
            if j is None or end is None or parents[j] < 0 or np.allclose(rest[end], rest[j]):
                continue
            p = parents[j]
            while parents[p] >= 0 and anatomy[p].rpartition("_")[0] in TO_TRUNK:
                p = parents[p]
            before = frames.get(p, trunk["shoulder" if station in ("shoulder", "elbow") else "hip"])
            frames[j] = _least(before, joint.along, rest[end] - rest[j])
            moving[j] = R[:, j] @ frames[j]
            axial = _axial(station, side, at, still, X, R, moving[j], frames[j], takes)
            if axial is not None:
                moving[j] = turned(moving[j], axial.turn)
            if station != "ankle":
                rotation_seen[f"{station}_{side}"] = np.zeros(len(X), bool) if axial is None else axial.is_seen
            above = moving.get(p, (R[:, p] if station != "hip" or pelvis is None else pelvis(R[:, p])) @ before)
            turn = above.transpose(0, 2, 1) @ moving[j]
            three_angles = _three(turn if side == "r" else MIRROR @ turn @ MIRROR, station)
            angles |= {f"{station}_{side}.{name}": a for name, a in zip(joint.angles, three_angles, strict=True)}
    return JointAngles(angles, rotation_seen)


def _axial(
    station: str,
    side: str,
    at: Mapping[str, int],
    still: Collection[str],
    X: Floats,
    R: Floats,
    axes: Floats,
    rest: Floats,
    takes: Sequence[slice] | None,
) -> AxialTurn | None:
    """How a segment is turned about its length, as what lies beyond it shows; None where nothing beyond it was found."""

    def beyond(*stations: str) -> int | None:
        return next((at[f"{s}_{side}"] for s in stations if f"{s}_{side}" in at), None)

    if station in ("hip", "shoulder"):
        bending = beyond("knee" if station == "hip" else "elbow")
        end = beyond(*JOINTS["knee" if station == "hip" else "elbow"].ends)
        if bending is None or end is None:
            return None
        return turn_of_bend(axes, X[:, end] - X[:, bending], -1.0 if station == "hip" else 1.0, takes)
    if station == "knee":
        ankle, toes = beyond("ankle"), beyond("toe", "foot_end")
        return None if ankle is None or toes is None else turn_of_direction(axes, X[:, toes] - X[:, ankle], takes)
    wrist = beyond("wrist") if station == "elbow" and f"wrist_{side}" not in still else None
    return None if wrist is None else turn_of_part(axes, R[:, wrist], rest, takes)


def _three(turn: Floats, station: str) -> tuple[Floats, Floats, Floats]:
    """(frame,) degrees: the three angles of one joint, of a right limb.

    turn : (frame, 3, 3) axes of the segment in those of the segment before it
    """
    if station == "shoulder":  # Ry(plane) Rx(−elevation) Ry(rotation)
        plane = np.arctan2(-turn[:, 0, 1], -turn[:, 2, 1])
        elevation = np.arccos(np.clip(turn[:, 1, 1], -1.0, 1.0))
        rotation = np.arctan2(-turn[:, 1, 0], turn[:, 1, 2])
        return np.degrees(plane), np.degrees(elevation), np.degrees(rotation)
    flexion = np.degrees(np.arctan2(-turn[:, 0, 1], turn[:, 1, 1]))  # Rz Rx Ry
    adduction = np.degrees(np.arcsin(np.clip(turn[:, 2, 1], -1.0, 1.0)))
    rotation = np.degrees(np.arctan2(-turn[:, 2, 0], turn[:, 2, 2]))
    return -flexion if station == "knee" else flexion, adduction, rotation  # knees bend backwards


def _trunk(at: Mapping[str, int], rest: Floats, front: Floats, up: Floats, station: str) -> Floats:
    """(3, 3) axes by columns of pelvis or thorax: z from the left to the right joint, or to the right where one lacks; y up."""
    left, right = at.get(f"{station}_l"), at.get(f"{station}_r")
    return _axes(np.cross(front, up) if left is None or right is None else rest[right] - rest[left], up)


def _pelvis(at: Mapping[str, int], rest: Floats, X: Floats, up: Floats) -> Callable[[Floats], Floats] | None:
    """How the pelvis turns from the reference pose, given how its part turns; None without both hips (after Wu 2002).

    Its axes: z from the left to the right hip, y towards a joint of the spine, or where none is far enough, what was up in
    its part.
    """
    left, right = at.get("hip_l"), at.get("hip_r")
    if left is None or right is None:
        return None
    across, middle = rest[right] - rest[left], (rest[right] + rest[left]) / 2.0
    width = float(np.linalg.norm(across))
    spine = next((at[s] for s in SPINE if s in at and np.linalg.norm(rest[at[s]] - middle) > LEVER * width), None)

    def turned(part: Floats) -> Floats:
        along = part @ up if spine is None else X[:, spine] - (X[:, left] + X[:, right]) / 2.0
        before = _axes(across, up if spine is None else rest[spine] - middle)
        return np.asarray(_axes(X[:, right] - X[:, left], along) @ before.T)

    return turned


def _axes(across: Floats, along: Floats) -> Floats:
    """(…, 3, 3) x, y and z by columns: z across, y as far along as it can be."""
    z = across / np.linalg.norm(across, axis=-1, keepdims=True)
    y = along - np.sum(along * z, axis=-1, keepdims=True) * z
    y /= np.linalg.norm(y, axis=-1, keepdims=True)
    return np.stack([np.cross(y, z), y, z], axis=-1)


def _least(axes: Floats, along: Floats, direction: Floats) -> Floats:
    """Axes rotated as little as possible so that one of their directions points somewhere (Rodrigues)."""
    a, b = axes @ along, direction / np.linalg.norm(direction)
    v, c = np.cross(a, b), float(a @ b)
    if c < -1.0 + 1e-9:
        side = axes[:, 2]
        return np.asarray((2.0 * np.outer(side, side) - np.eye(3)) @ axes)
    K = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray((np.eye(3) + K + K @ K / (1.0 + c)) @ axes)
