"""How a segment is turned about its own length, told by what lies beyond it: a bent elbow or knee, a hand, a foot (ours).

The surface of a round limb hardly shows this turn. The plane in which the next joint is bent does (Wu 2005, second option for
the humerus), and so does the hand for the forearm and the foot for the shank. In frames that do not show it, since the joint is
straight there, the difference to what the surface says is between that of the frames of the same take before and after.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats

BENT = 15.0
"""Least bend of an elbow or knee, or angle of a foot to its shank, that shows how the segment before is turned, degrees. Chosen
on twelve generated people: 8° and 11° do as well, 25° and more are worse."""


class AxialTurn(NamedTuple):
    """What must be added to the surface's turn about the segment.

    turn    : (frame,) radians, about the y axis of the segment
    is_seen : (frame,) whether this frame shows it
    """

    turn: Floats
    is_seen: Flags


def turn_of_bend(axes: Floats, next_segment: Floats, sign: float, takes: Sequence[slice] | None = None) -> AxialTurn:
    """By the plane in which the next joint is bent: its axis is the segment's z axis.

    axes         : (frame, 3, 3) of the segment as its surface shows them, by columns, y against its direction
    next_segment : (frame, xyz) from the next joint to the end of its segment
    sign         : 1 where flexion turns about z, as an elbow's; −1 where it turns the other way, as a knee's
    takes        : positions of the frames of each take; None takes all as one
    """
    f = next_segment / np.maximum(np.linalg.norm(next_segment, axis=1, keepdims=True), 1e-300)
    hinge = sign * np.cross(-axes[:, :, 1], f)
    bent = np.degrees(np.arctan2(np.linalg.norm(hinge, axis=1), np.sum(-axes[:, :, 1] * f, axis=1)))
    return filled(_about_y(axes, hinge, 2), bent >= BENT, takes)


def turn_of_direction(axes: Floats, ahead: Floats, takes: Sequence[slice] | None = None, least: float = BENT) -> AxialTurn:
    """By a direction beyond the segment that lies in its x–y plane, such as a foot's.

    ahead : (frame, xyz) mesh unit
    takes : positions of the frames of each take; None takes all as one
    least : angle of the direction to the segment from which on it shows the turn, degrees
    """
    length = np.maximum(np.linalg.norm(ahead, axis=1), 1e-300)
    away = np.degrees(np.arccos(np.clip(np.abs(np.sum(ahead * axes[:, :, 1], axis=1)) / length, 0.0, 1.0)))
    return filled(_about_y(axes, ahead, 0), away >= least, takes)


def turn_of_part(axes: Floats, part: Floats, rest: Floats, takes: Sequence[slice] | None = None) -> AxialTurn:
    """By the part beyond the segment, without what it swings against it, such as a hand.

    part  : (frame, 3, 3) rotation from the reference pose of the part beyond
    rest  : (3, 3) axes of the segment in the reference pose
    takes : positions of the frames of each take; None takes all as one
    """
    carried = part @ rest
    a, b = carried[:, :, 1], axes[:, :, 1]
    v, c = np.cross(a, b), np.sum(a * b, axis=1)
    z = carried[:, :, 2]
    swung = z * c[:, None] + np.cross(v, z) + v * (np.sum(v * z, axis=1) / np.maximum(1.0 + c, 1e-9))[:, None]
    return filled(_about_y(axes, swung, 2), c > -0.5, takes)


def filled(turn: Floats, is_seen: Flags, takes: Sequence[slice] | None = None) -> AxialTurn:
    """The turn with that of frames that do not show it between those of the frames before and after, on the shorter way.

    takes   : positions of the frames of each take; None takes all as one
    returns : 0 throughout a take in which no frame shows it
    """
    whole = np.zeros(len(turn))
    for take in takes or [slice(0, len(turn))]:
        at = take.start + np.flatnonzero(is_seen[take])
        if len(at):
            whole[take] = np.interp(np.arange(take.start, take.stop), at, np.unwrap(turn[at]))
    return AxialTurn(whole, is_seen)


def turned(axes: Floats, turn: Floats) -> Floats:
    """(frame, 3, 3) axes turned about their own y."""
    c, s = np.cos(turn)[:, None], np.sin(turn)[:, None]
    x, y, z = axes[:, :, 0], axes[:, :, 1], axes[:, :, 2]
    return np.stack([c * x - s * z, y, s * x + c * z], axis=2)


def _about_y(axes: Floats, towards: Floats, axis: int) -> Floats:
    """(frame,) radians about y that bring the x or z axis as near to a direction as they can."""
    x, z = (np.sum(axes[:, :, k] * towards, axis=1) for k in (0, 2))
    return np.asarray(np.arctan2(x, z) if axis == 2 else np.arctan2(-z, x))
