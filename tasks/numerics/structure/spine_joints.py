"""Joints of a person's spine lie behind the middle of the trunk, and amid it from side to side (ours).

Rings across a trunk show where along it the spine bends, but hardly where in its cross-section: flesh all around goes along.
The bodies of vertebrae lie at a third to two fifths of the trunk's depth, from the back. So where the limbs say that a body is
a person's, and which way it faces, two places say how deep a joint of its spine lies, along the direction that the trunk faces
there: behind where motion has it, and at that share of the depth. It goes to their mean, since each errs on its own: motion by
how rigid the flesh is, the share by how rigs and bodies differ. From side to side it goes half of the way to the middle.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.inside import depth_along
from kinetree.tasks.numerics.structure.anatomy import anatomy
from kinetree.tasks.numerics.structure.limb_motion import Motion
from kinetree.tasks.numerics.structure.limbs import Limb


class SpineJointsSettings(NamedTuple):
    """Where in the trunk the spine lies."""

    behind: float = 0.25
    """Way back from where motion has a joint, in radii of its border. After anatomy: at a third of the depth a joint lies 0.33
    of half the depth behind the middle, at two fifths 0.2; the radius has the breadth too, so that half the depth is nine
    tenths of it. See RESULTS for other values."""
    from_back: float = 1 / 3
    """Depth of the spine from the back, share of the trunk's depth at the joint. Of the third and the two fifths that anatomy
    gives the third, since true joints of recordings lie nearer to the back still, at 0.13 to 0.29. See RESULTS for other
    values."""
    depth_bounds: tuple[float, float] = (1.0, 2.5)
    """Depth of a trunk, in radii of the border, at least and at most; it is 1.4 to 1.9. Elsewhere the border does not go
    across the trunk, or an arm is one surface with it, and motion alone counts. Not varied."""
    breadth_bounds: tuple[float, float] = (1.5, 2.8)
    """Breadth of a trunk, the same. Of recorded and generated people it is 1.9 to 2.6. With 3.2 humans 20 to 29 lose: hips and
    shoulders are as broad."""
    certainty: float = 0.5
    """Of the front, at least, see `Anatomy`: half of what both feet say when nothing speaks against them. Not varied."""


def spine_shifts(V: Floats, F: Ints, body: Motion, radius: Floats, settings: SpineJointsSettings | None = None) -> Floats:
    """(joint, xyz) how far joints go in the reference, mesh unit; nothing but for joints of a person's spine.

    V, F   : (vertex, xyz) reference, mesh unit · (face, corner)
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
        along = _unit(way[k + 1] - way[k - 1])
        ahead = _unit(np.cross((1.0 - share) * across[0] + share * across[1], along))
        aside = np.cross(along, ahead)
        place, size = body.rest[joint].copy(), float(radius[joint])
        behind, before = _both_ways(place, -ahead, V, F)
        is_within = _between_bounds(behind + before, size, chosen.depth_bounds)
        place -= _way_back(behind, before, size, is_within, chosen) * ahead
        if is_within:
            left, right = _both_ways(place, aside, V, F)
            if _between_bounds(left + right, size, chosen.breadth_bounds):
                place += (left - right) / 4.0 * aside
        shift[joint] = place - body.rest[joint]
    return shift


def _both_ways(place: Floats, direction: Floats, V: Floats, F: Ints) -> tuple[float, float]:
    """How far the surface is in a direction and in the opposite one, mesh unit; infinite where there is none."""
    there, back = depth_along(np.repeat(place[None], 2, axis=0), np.stack([direction, -direction]), V, F, 0.0)
    return float(there), float(back)


def _way_back(behind: float, before: float, radius: float, is_within: bool, chosen: SpineJointsSettings) -> float:
    """How far a joint goes back, mesh unit, never through the surface; less than 0 where it goes towards the front.

    behind, before : from the joint to the surface, mesh unit; infinite where the joint is outside
    is_within      : whether both together are as deep as a trunk
    """
    by_motion = min(chosen.behind * radius, behind)
    return (by_motion + behind - chosen.from_back * (behind + before)) / 2.0 if is_within else by_motion


def _between_bounds(size: float, radius: float, bounds: tuple[float, float]) -> bool:
    """Whether a size, mesh unit, lies between bounds in radii of the border."""
    least, most = bounds
    return least * radius <= size <= most * radius


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
