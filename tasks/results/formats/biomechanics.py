"""Tables for the study of movement: anatomical angles, turns about bones, steps (ours)."""

import json
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.joint_names import CERTAIN_FRONT, JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.results.gait import Event, gait_events, strides, symmetry_index
from kinetree.tasks.numerics.results.joint_angles import joint_angles
from kinetree.tasks.numerics.results.placement import upright_rotation
from kinetree.tasks.numerics.results.swing_twist import swing_twist
from kinetree.tasks.results.formats.rig import local_rotations, rest_frames, seconds
from kinetree.tasks.results.formats.tables import Column, Table, series

FEET: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "foot": (("ankle", "foot_end", "toe"), ("foot_end", "toe", "ankle")),
    "hind_foot": (("hind_foot_end", "hind_toe", "hind_ankle"),) * 2,
    "fore_foot": (("fore_foot_end", "fore_toe", "fore_wrist"),) * 2,
}
"""Stations that may stand for the heel and for the toes of each foot, the best first."""


def turn_table(skeleton: Skeleton) -> Table:
    """A row a frame; for every joint that turns, its twist about its bone and the swing of the bone about both axes across.

    Degrees from the reference pose, in the axes of the joint at rest: y along the bone.
    """
    B, parents = rest_frames(skeleton.rest, skeleton.parents), skeleton.parents
    rest = local_rotations(np.broadcast_to(np.eye(3), (1, *B.shape)), B, parents)[0]
    turn = rest.transpose(0, 2, 1) @ local_rotations(skeleton.rotation, B, parents)
    columns: dict[str, Floats] = {}
    for j, (name, kind) in enumerate(zip(skeleton.names, skeleton.kinds, strict=True)):
        if kind == "joint":
            parts = swing_twist(turn[:, j])
            columns |= {f"{name}.{what}": parts[:, k] for k, what in enumerate(("swing_x", "twist", "swing_z"))}
    return series(skeleton, list(columns), np.column_stack([np.empty((len(turn), 0)), *columns.values()]))


def anatomical_table(skeleton: Skeleton, names: JointNames, up: str, still: Collection[str] = ()) -> Table | None:
    """A row a frame with signed angles of hips, knees, ankles, shoulders and elbows; None where the front is not certain.

    Column rotation_seen of a joint is 1 in frames that show its internal rotation or pronation, 0 where it is between those.

    still : anatomical names of joints at which no turn was measured, which have no angles
    """
    if names.topology != "human" or names.front_confidence < CERTAIN_FRONT:
        return None
    s = skeleton
    moving = np.array(s.rest), np.array(s.positions), np.array(s.rotation)
    takes = take_spans(s.frames)
    angles = joint_angles(names.anatomy, s.parents, *moving, np.array(names.front), _upwards(up), takes, still)
    name_of = dict(zip(names.anatomy, s.names, strict=True))
    degrees = {name: a for name, a in angles.degrees.items() if name.partition(".")[0] not in still}
    seen = {joint: a for joint, a in angles.rotation_seen.items() if joint not in still}
    titles = [f"{name_of[joint]}.{angle}" for joint, _, angle in (name.partition(".") for name in degrees)]
    titles += [f"{name_of[joint]}.rotation_seen" for joint in seen]
    columns = [*degrees.values(), *seen.values()]
    return series(s, titles, np.column_stack([np.empty((len(s.frames), 0)), *columns]))


def gait_files(skeleton: Skeleton, names: JointNames, up: str) -> tuple[Table, bytes] | None:
    """The table of strikes and toe-offs, and what they say of both sides as JSON; None where the body does not walk."""
    if names.topology == "unknown" or names.front_confidence < CERTAIN_FRONT:
        return None
    at = {name: j for j, name in enumerate(names.anatomy) if name}
    chosen = {f"{foot}_{side}": _foot(at, foot, side) for foot in FEET for side in "lr"}
    feet = {name: pair for name, pair in chosen.items() if pair is not None and chosen[f"{name[:-1]}{_other(name[-1])}"]}
    if not feet:
        return None
    upwards, X = _upwards(up), skeleton.positions
    ahead = skeleton.rotation[:, 0] @ names.front
    ahead -= np.outer(ahead @ upwards, upwards)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-12)
    heels, toes = (X[:, [pair[k] for pair in feet.values()]] for k in (0, 1))
    legs = [_leg(skeleton, pair[1]) for pair in feet.values()]
    events = gait_events(heels, toes, X[:, 0], ahead, legs, seconds(skeleton, skeleton.fps or 1.0))
    if not events:
        return None
    return _events(skeleton, events, list(feet)), _summary(skeleton, events, list(feet))


def _events(skeleton: Skeleton, events: Sequence[Event], feet: Sequence[str]) -> Table:
    """A row an event."""
    count = np.arange(len(skeleton.frames))
    frames = [round(float(np.interp(e.sample, count, skeleton.frames))) for e in events]
    columns: dict[str, Column] = {"foot": [feet[e.foot] for e in events], "event": [e.kind for e in events], "frame": frames}
    known = skeleton.fps is not None
    return Table(columns | {"seconds": np.array([e.time if known else np.nan for e in events])})


def _summary(skeleton: Skeleton, events: Sequence[Event], feet: Sequence[str]) -> bytes:
    """Strides and stances of every foot, and how symmetric left and right are."""
    unit = "seconds" if skeleton.fps else "frames"
    of_foot: dict[str, dict[str, object]] = {}
    means: dict[str, tuple[float, float]] = {}
    for k, foot in enumerate(feet):
        stride, stance = strides(events, k)
        whole = np.isfinite(stance)
        of_foot[foot] = {"strides": len(stride)}
        if whole.any():
            means[foot] = float(stride.mean()), float(np.mean(stance[whole] / stride[whole]))
            of_foot[foot] |= {f"stride_{unit}": round(means[foot][0], 4), "stance_share": round(means[foot][1], 4)}
    pairs = {foot[:-2] for foot in feet if {f"{foot[:-1]}l", f"{foot[:-1]}r"} <= set(means)}
    symmetry = {
        foot: {
            what: round(symmetry_index(means[f"{foot}_l"][k], means[f"{foot}_r"][k]), 2)
            for k, what in enumerate(("stride_percent", "stance_percent"))
        }
        for foot in sorted(pairs)
    }
    content = {"method": "Zeni, Richards, Higginson 2008", "feet": of_foot, "symmetry": symmetry}
    return (json.dumps(content, indent=1) + "\n").encode()


def _foot(at: Mapping[str, int], foot: str, side: str) -> tuple[int, int] | None:
    """The joints that stand for heel and toes of a foot."""
    heel, toe = (next((at[f"{s}_{side}"] for s in stations if f"{s}_{side}" in at), None) for stations in FEET[foot])
    return None if heel is None or toe is None else (heel, toe)


def _other(side: str) -> str:
    return "r" if side == "l" else "l"


def _leg(skeleton: Skeleton, foot: int) -> float:
    """Length of the bones from the root to a foot."""
    length, j = 0.0, foot
    while skeleton.parents[j] >= 0:
        length, j = length + float(skeleton.lengths[j]), skeleton.parents[j]
    return length


def _upwards(up: str) -> Floats:
    """(xyz,) unit vector."""
    return np.asarray(upright_rotation(up).T @ np.array([0.0, 1.0, 0.0]))
