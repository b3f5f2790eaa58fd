"""Joints of a person's spine lie behind the middle of the trunk (ours).

Rings across a trunk show where along it the spine bends, but hardly how deep inside: flesh before and behind it goes along.
The bodies of vertebrae lie at a third to two fifths of the trunk's depth, from the back. So where the limbs say that a body is
a person's, and which way it faces, the joints of its spine go that far back, against the direction that the trunk faces there.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.anatomy import anatomy
from kinetree.tasks.numerics.structure.limb_motion import Motion
from kinetree.tasks.numerics.structure.limbs import Limb


class SpineJointsSettings(NamedTuple):
    """How far the spine is behind the middle."""

    behind: float = 0.25
    """Way back, in radii of the border at each joint. After anatomy: at a third of the depth a joint lies 0.33 of half the
    depth behind the middle, at two fifths 0.2; the radius has the breadth too, so that half the depth is nine tenths of it.
    Without it 0.23 to 0.42 are missing in three recordings, which share a rig."""
    certainty: float = 0.5
    """Of the front, at least, see `Anatomy`: half of what both feet say when nothing speaks against them. Not varied."""


def spine_shifts(body: Motion, radius: Floats, settings: SpineJointsSettings | None = None) -> Floats:
    """(joint, xyz) how far joints go in the reference, mesh unit; nothing but for joints of a person's spine.

    body   : with ends of bones
    radius : (joint,) of the border at every joint, mesh unit
    """
    chosen, shift = settings or SpineJointsSettings(), np.zeros_like(body.rest)
    found = anatomy(body)
    if found is None or found.topology != "human" or found.certainty < chosen.certainty:
        return shift
    legs, arms = found.pairs
    joints = spine(body.parents, legs, arms)
    low, high = (np.mean([body.rest[limb.joints[-1]] for limb in pair], axis=0) for pair in (legs, arms))
    across = [_unit(body.rest[left.joints[-1]] - body.rest[right.joints[-1]]) for left, right in (legs, arms)]
    way = np.array([low, *(body.rest[j] for j in joints), high])
    for k, joint in enumerate(joints, start=1):
        share = k / (len(joints) + 1)
        left = (1.0 - share) * across[0] + share * across[1]
        shift[joint] = -chosen.behind * radius[joint] * _unit(np.cross(left, way[k + 1] - way[k - 1]))
    return shift


def spine(parents: Ints, legs: tuple[Limb, Limb], arms: tuple[Limb, Limb]) -> list[int]:
    """The joints between where the legs and where the arms hang, of both sides, from the legs on.

    parents : (joint,) −1 for the root
    """
    left, right = (_between(parents, leg.base, arm.base) for leg, arm in zip(legs, arms, strict=True))
    return [joint for joint in left if joint in right]


def _between(parents: Ints, first: int, last: int) -> list[int]:
    """Joints whose two parts lie on the way from one joint's part to another's, in order."""
    up, down = _to_root(parents, first), _to_root(parents, last)
    shared = next(j for j in up if j in down)
    return [*up[: up.index(shared)], *reversed(down[: down.index(shared)])]


def _to_root(parents: Ints, joint: int) -> list[int]:
    """A joint and those above it, up to the root; parents (joint,)."""
    way = [joint]
    while parents[way[-1]] >= 0:
        way.append(int(parents[way[-1]]))
    return way


def _unit(v: Floats) -> Floats:
    """The vector at length 1; nothing where it has none."""
    return np.asarray(v / max(float(np.linalg.norm(v)), 1e-300))
