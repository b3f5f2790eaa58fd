"""Where joints lie that a person or a four-legged animal has and that were not found (ours).

Such a joint lies on a bone that was found in one piece. Its place on the bone is that of the same joint on the other side, else
of published proportions of people (Drillis and Contini 1966, as in Winter 2009). Here it is told how far
along the bone it lies; `limb_sections` finds the middle of the limb there, beside the bone where the joint was held bent.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.anatomical_names import Named

CHAINS: Mapping[str, tuple[tuple[str, ...], ...]] = {
    "human": (("hip", "knee", "ankle", "toe", "foot_end"), ("shoulder", "elbow", "wrist", "finger", "hand_end")),
    "quadruped": (
        ("hind_hip", "hind_knee", "hind_ankle", "hind_toe", "hind_foot_end"),
        ("fore_shoulder", "fore_elbow", "fore_wrist", "fore_toe", "fore_foot_end"),
    ),
}
"""Stations of limbs from the trunk outwards, by topology."""
ASSUMED = ("knee", "ankle", "elbow", "wrist", "hind_knee", "hind_ankle", "fore_elbow", "fore_wrist")
"""Stations that may be assumed. Limbs hang on the trunk in hips and shoulders, which only motion shows."""
SEGMENTS: Mapping[tuple[str, str], float] = {
    ("hip", "knee"): 0.245, ("knee", "ankle"): 0.246, ("ankle", "foot_end"): 0.039,
    ("shoulder", "elbow"): 0.186, ("elbow", "wrist"): 0.146, ("wrist", "hand_end"): 0.108,
}  # fmt: skip
"""Lengths of people's segments, shares of the body's height (Drillis and Contini 1966); of the foot its height."""
HEAD_AND_NECK = 0.182
"""From the crown to the base of the neck, share of the body's height (the same)."""
TRUNK = ("pelvis", "torso", "spine", "spine_1", "spine_2", "chest")
"""Stations on which the neck may stand."""
MARGIN = 0.05
"""A joint nearer than this to an end of its bone, share of the bone, is that end."""


class Assumed(NamedTuple):
    """A joint on a bone.

    named  : station and side
    child  : the joint at the bone's outer end
    share  : place along the bone, 0 at the inner end, 1 at the outer
    source : where the place is from
    """

    named: Named
    child: int
    share: float
    source: Literal["mirror", "proportions"]


def assumed_joints(rest: Floats, parents: Sequence[int], anatomy: Sequence[str], topology: str) -> list[Assumed]:
    """The joints that the body must have and that were not found, ordered along each bone from its inner end  (ours).

    A bone between two stations is divided only where no other joint lies between them.

    rest     : (joint, xyz) in the reference pose, mesh unit
    parents  : (joint,) parents first, −1 for the root
    anatomy  : (joint,) station and side of each joint; empty where there is none
    topology : human or quadruped; of other bodies nothing is assumed
    """
    at = {name: j for j, name in enumerate(anatomy) if name}
    assumed = []
    for chain in CHAINS.get(topology, ()):
        for side, other in ("lr", "rl"):
            here = _of_side(at, chain, side)
            for inner, outer in pairwise([station for station in chain if station in here]):
                wanted = [s for s in chain[chain.index(inner) + 1 : chain.index(outer)] if s in ASSUMED]
                if not wanted or parents[here[outer]] != here[inner]:
                    continue
                stations = (inner, *wanted, outer)
                shares = _mirrored(rest, parents, _of_side(at, chain, other), stations)
                source: Literal["mirror", "proportions"] = "proportions" if shares is None else "mirror"
                shares = _proportional(stations) if shares is None else shares
                assumed += [
                    Assumed(Named(station, side), here[outer], share, source)
                    for station, share in zip(wanted, shares or (), strict=bool(shares))
                ]
    if topology == "human" and (neck := _neck(rest, parents, at)) is not None:
        assumed.append(neck)
    return [joint for joint in assumed if MARGIN < joint.share < 1.0 - MARGIN]


def _of_side(at: Mapping[str, int], chain: Sequence[str], side: str) -> dict[str, int]:
    """The joints of a limb by station."""
    return {station: at[f"{station}_{side}"] for station in chain if f"{station}_{side}" in at}


def _mirrored(
    rest: Floats, parents: Sequence[int], limb: Mapping[str, int], stations: Sequence[str]
) -> tuple[float, ...] | None:
    """Shares of the way along a limb between the first and the last station; None where the limb lacks one of them."""
    if any(station not in limb for station in stations):
        return None
    steps = [_way(rest, parents, limb[a], limb[b]) for a, b in pairwise(stations)]
    return _shares([step for step in steps if step is not None]) if None not in steps else None


def _proportional(stations: Sequence[str]) -> tuple[float, ...] | None:
    """The same by published proportions; None where they do not tell a segment."""
    steps = [SEGMENTS.get(pair) for pair in pairwise(stations)]
    return _shares([step for step in steps if step is not None]) if None not in steps else None


def _shares(steps: Sequence[float]) -> tuple[float, ...] | None:
    """Where steps end, shares of their sum, without the last one; None where they have no length."""
    ends = np.cumsum(steps)
    return tuple((ends[:-1] / ends[-1]).tolist()) if ends[-1] > 0.0 else None


def _way(rest: Floats, parents: Sequence[int], inner: int, outer: int) -> float | None:
    """Way along bones from a joint up to one above it, mesh unit; None where it is not above it."""
    way, j = 0.0, outer
    while j != inner:
        if parents[j] < 0:
            return None
        way, j = way + float(np.linalg.norm(rest[j] - rest[parents[j]])), parents[j]
    return way


def _neck(rest: Floats, parents: Sequence[int], at: Mapping[str, int]) -> Assumed | None:
    """The base of the neck of a person whose head and trunk were found in one piece."""
    height, child = _height(rest, parents, at), at.get("head", at.get("head_end"))
    if "neck" in at or "head_end" not in at or height is None or child is None or parents[child] not in _trunk(at):
        return None
    beyond, bone = _way(rest, parents, child, at["head_end"]), float(np.linalg.norm(rest[child] - rest[parents[child]]))
    if beyond is None or bone <= 0.0:
        return None
    return Assumed(Named("neck"), child, 1.0 - (HEAD_AND_NECK * height - beyond) / bone, "proportions")


def _trunk(at: Mapping[str, int]) -> set[int]:
    """The joints of the trunk."""
    return {at[station] for station in TRUNK if station in at}


def _height(rest: Floats, parents: Sequence[int], at: Mapping[str, int]) -> float | None:
    """A person's height by the segments that were found, mesh unit; feet and hands, whose ends lie anywhere, do not count."""
    heights = []
    for (a, b), share in SEGMENTS.items():
        for side in "lr":
            ends = at.get(f"{a}_{side}"), at.get(f"{b}_{side}")
            if ends[0] is not None and ends[1] is not None and not b.endswith("_end"):
                way = _way(rest, parents, ends[0], ends[1])
                heights += [] if way is None else [way / share]
    return float(np.median(heights)) if heights else None
