"""How far parts turn against each other: ranges of angles, displacement of a surface, rotations that follow others (ours)."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import nearest_rotation
from kinetree.tasks.numerics.structure.score_spans import score_spans

MOST_COMPARED = 96
"""Frames whose rotations are compared each with each, about; for time."""
FEW_FRAMES = 16
"""Frames of all takes below which no rotation is left out."""
OUT_OF_ROUND = 0.1
"""Share of a roll's displacement along the normals, from which on the surface shows the roll in full. Not recorded."""


def turning_range(turns: Floats, frames: int | None = None) -> float:
    """The widest angle in degrees between any two rotations (frame, 3, 3), without those of two frames, which may be wrong.

    Of fewer than 16 frames one may be wrong, of fewer than 8 none. If the body has fewer than 16 in all, none is left out: of
    so few, a joint often turns in one alone.

    frames : how many the body has; None for as many as there are rotations
    """
    every = turns[:: max(1, len(turns) // MOST_COMPARED)].reshape(-1, 9)
    cosine = (every @ every.T - 1.0) / 2.0
    rank = min(3, 1 + len(every) // 8) if (frames or len(turns)) >= FEW_FRAMES else 1
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    third = np.sort(angle, axis=1)[:, -rank]
    return float(np.degrees(np.sort(third)[-rank]))


def widest_turning_range(turns: Floats, spans: Ints) -> float:
    """The widest `turning_range` of rotations (frame, 3, 3) over any of the spans (span, 2), see `score_spans`; degrees."""
    return max(turning_range(turns[begin:end], len(turns)) for begin, end in spans)


def joint_degrees(R: Floats, parents: Ints, turns: Flags, takes: Sequence[slice] | None = None) -> Floats:
    """(joint,) range of turning of every joint against its parent, degrees; 0 where it does not turn.

    R       : (frame, joint, 3, 3)
    parents : (joint,) −1 for the root
    turns   : (joint,) whether a joint turns: not the root, and no leaf
    takes   : positions of the frames of each take; None takes all as one
    """
    spans = score_spans(len(R), takes)
    against = (np.einsum("txy,txz->tyz", R[:, p], R[:, j]) for j, p in enumerate(parents))
    return np.array([widest_turning_range(r, spans) if turn else 0.0 for r, turn in zip(against, turns, strict=True)])


def mean_rotation(turns: Floats) -> Floats:
    """(3, 3) the rotation nearest to the mean of those given (frame, 3, 3)."""
    return nearest_rotation(turns.mean(axis=0))


def principal_axis(turns: Floats) -> Floats:
    """(xyz,) unit vector about which rotations (frame, 3, 3) turn most, against their mean."""
    w = Rotation.from_matrix(turns @ mean_rotation(turns).T).as_rotvec()
    return np.asarray(np.linalg.eigh(w.T @ w)[1][:, -1])


def swing(V: Floats, area: Floats, centre: Floats, turns: Floats, above: bool, N: Floats | None = None) -> float:
    """Root mean square displacement, over frames and a part's surface, by turning about a joint against the mean pose.

    V, area : (vertex, xyz), (vertex,) of the part, mesh unit
    centre  : (xyz) the joint, mesh unit
    turns   : (frame, 3, 3) R_pᵀ R_a of a part a against the part p above it
    above   : whether V is of p
    N       : (vertex, xyz) normals, where only the surface was seen to move: then the roll of a round limb about its own axis,
              which leaves the surface where it is, does not count; None where every vertex was followed
    returns : mesh unit
    """
    mean = mean_rotation(turns)
    base = np.eye(3) if above else mean.T
    arm = (V - centre) @ base
    share = area / max(float(area.sum()), np.finfo(float).tiny)
    away = turns @ mean.T - np.eye(3)
    square = float(np.einsum("txy,yz,txz->t", away, (share[:, None] * arm).T @ arm, away).mean())
    if N is not None:
        axis = share @ arm
        axis /= max(float(np.linalg.norm(axis)), np.finfo(float).tiny)
        around = np.cross(axis, arm)
        whole = float(share @ (around**2).sum(axis=1))
        shown = float(share @ ((around * (N @ base)).sum(axis=1)) ** 2)
        roll = Rotation.from_matrix(turns @ mean.T).as_rotvec() @ axis
        square -= float((roll**2).mean()) * (whole - min(whole, shown / OUT_OF_ROUND))
    return float(np.sqrt(max(square, 0.0)))


def in_between(turns: Floats, beyond: Floats) -> float:
    """How well a fixed share of the rotation of the part beyond it, between none and all, explains a part's rotation.

    Flesh around a joint turns by a share of what the joint turns by; a bone of its own turns by itself.

    turns, beyond : (frame, 3, 3) of the part and of that beyond it, against the part above both
    returns       : 0 to 1, share of its variance explained so, or of that of the remaining rotation if it is less
    """
    u, v = (Rotation.from_matrix(r @ mean_rotation(r).T).as_rotvec() for r in (turns, beyond))
    share = float((u * v).sum() / max(float((v * v).sum()), 1e-300))
    least = min(float((u * u).sum()), float(((v - u) ** 2).sum()))
    if not 0.0 < share < 1.0 or least <= 0.0:
        return 0.0
    return max(0.0, 1.0 - float(((u - share * v) ** 2).sum()) / least)
