"""Joint-angle curves and forward kinematics of a figure; what a truth file says about them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.input.synth.descriptions import Curve, Motion
from kinetree.tasks.numerics.input.synth.figures import Figure


class TruthSettings(NamedTuple):
    """From which angle on a joint counts; turning is the largest angle between two frames of the clip."""

    scored: float = 15.0
    """Degrees from which a joint is scored."""
    rigid: float = 0.5
    """Degrees below which the two sides of a joint are one rigid part."""


_SETTINGS = TruthSettings()


def curve_values(curve: Curve, seconds: Floats) -> Floats:
    """Value of one curve: offset + amplitude · sin 2π(frequency·s + phase), or the smooth curve through its keys.

    Keys without a period are joined by the monotone spline; with a period they repeat, and each way from one to the next has
    the least jerk: 10u³ − 15u⁴ + 6u⁵, as people move (Flash and Hogan 1985).

    seconds : (frame,)
    returns : (frame,) degrees, or the figure's unit when the curve slides; before the first and after the last key of those
              that do not repeat the nearest key's value holds
    """
    if curve.keys:
        knots = np.array(curve.keys, dtype=np.float64)
        if curve.period:
            return _repeated(knots, curve.period, seconds) + curve.offset
        clamped = np.clip(seconds, knots[0, 0], knots[-1, 0])
        return np.asarray(PchipInterpolator(knots[:, 0], knots[:, 1])(clamped) + curve.offset, dtype=np.float64)
    return curve.offset + curve.amplitude * np.sin(2.0 * np.pi * (curve.frequency * seconds + curve.phase))


def _repeated(knots: Floats, period: float, seconds: Floats) -> Floats:
    """(frame,) values of keys that repeat every `period` seconds; knots : (key, 2) seconds and values."""
    times, values = np.append(knots[:, 0], knots[0, 0] + period), np.append(knots[:, 1], knots[0, 1])
    at = times[0] + np.mod(seconds - times[0], period)
    k = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(knots) - 1)
    u = (at - times[k]) / (times[k + 1] - times[k])
    return np.asarray(values[k] + (values[k + 1] - values[k]) * u**3 * (10.0 - 15.0 * u + 6.0 * u**2), dtype=np.float64)


def joint_rotations(figure: Figure, motion: Motion, seconds: Floats) -> tuple[Floats, Floats]:
    """Rotation of every joint against its parent, and the root's shift, in every frame.

    A joint's curves multiply in their order, the first outermost; axes are those of the rest pose.

    seconds : (frame,)
    returns : (frame, joint, 3, 3) rotations and (frame, xyz) shift in the figure's unit
    """
    R = np.tile(np.eye(3), (len(seconds), len(figure.joints), 1, 1))
    shift = np.zeros((len(seconds), 3))
    for j, joint in enumerate(figure.joints):
        for curve in motion.get(joint.name, ()):
            value, axis = curve_values(curve, seconds), np.array(curve.axis)
            if curve.slides:
                shift += value[:, None] * axis
            else:
                R[:, j] = R[:, j] @ Rotation.from_rotvec(np.radians(value)[:, None] * axis).as_matrix()
    return R, shift


def forward_kinematics(rest: Floats, parents: Ints, R: Floats, shift: Floats) -> tuple[Floats, Floats]:
    """Positions and world rotations: x_j = x_p + G_p (r_j − r_p), G_j = G_p R_j.

    rest    : (joint, xyz), parents before their children; parents : (joint,), −1 at the root
    R       : (frame, joint, 3, 3) rotation against the parent; shift : (frame, xyz) of the root
    returns : (frame, joint, xyz) positions in the unit of `rest`, (frame, joint, 3, 3) world rotations
    """
    X = np.empty((*R.shape[:2], 3))
    G = np.empty_like(R)
    for j, p in enumerate(parents):
        if p < 0:
            X[:, j], G[:, j] = rest[j] + shift, R[:, j]
        else:
            X[:, j] = X[:, p] + G[:, p] @ (rest[j] - rest[p])
            G[:, j] = G[:, p] @ R[:, j]
    return X, G


def turning_angles(R: Floats) -> Floats:
    """How far every joint turns against its parent in the clip: the largest angle between any two of its frames.

    R       : (frame, joint, 3, 3) rotation against the parent
    returns : (joint,) degrees
    """
    angles = np.empty(R.shape[1])
    for j in range(R.shape[1]):
        q = Rotation.from_matrix(R[:, j]).as_quat()
        difference = Rotation.from_quat(q[:, None].repeat(len(q), axis=1).reshape(-1, 4)).inv() * Rotation.from_quat(
            np.tile(q, (len(q), 1))
        )
        angles[j] = np.degrees(difference.magnitude().max())
    return angles


def true_joints(figure: Figure, R: Floats) -> tuple[list[dict[str, Any]], list[list[str]]]:
    """What a truth file says about the joints of a clip, and the rigid parts that they carry.

    A joint is scored when it turns by at least 15° against its parent. A joint that hardly turns belongs to its
    parent's part.

    R       : (frame, joint, 3, 3) rotation against the parent
    returns : per joint {name, parent, kind, turns_deg, scored, part}, and per part the joints whose limbs it joins
    """
    turns = turning_angles(R)
    carries = {joint.parent for joint in figure.joints}
    joints: list[dict[str, Any]] = []
    parts: list[list[str]] = []
    for j, joint in enumerate(figure.joints):
        root, tip = joint.parent < 0, j not in carries
        if tip:
            part = None
        elif root or turns[j] >= _SETTINGS.rigid:
            part = len(parts)
            parts.append([joint.name])
        else:
            part = joints[joint.parent]["part"]
            parts[part].append(joint.name)
        angle = 0.0 if tip else float(turns[j])
        parent = None if root else figure.joints[joint.parent].name
        row = {"name": joint.name, "parent": parent, "kind": "tip" if tip else "joint", "turns_deg": round(angle, 1)}
        joints.append({**row, "scored": not root and angle >= _SETTINGS.scored, "part": part})
    return joints, parts
