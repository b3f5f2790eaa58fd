"""Joints that the mirror image of a limb has: where one foot has a ball, the other has one at the same distance (ours).

A toe that hardly turns, or that few vertices show, is found in one foot and not in the other. Limbs that are mirror images have
their joints equally far from their ends, so that the one tells where the other lies. No motion shows it, so it does not turn.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.end_cuts import EndCut, ring_at, share_beyond
from kinetree.tasks.numerics.structure.joint_partners import Limb, RootedParts, mirrored_limbs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.still_joints import StillJoint


class MirroredJointsSettings(NamedTuple):
    """Which joints are added. Not varied, but for `least_pairs`."""

    least_pairs: int = 2
    """Pairs of limbs of the body that are found, at least: of a body without mirror images two ends may be alike by chance. Of
    random trees 0 to 9 three have one pair, none has two. All 28 mirrored joints of people and of recorded and rigged bodies
    stay with this. Of quadrupeds one pair is found at most, so that they get none."""
    alike: float = 1.6
    """Radius of the ring in that of the other limb's border, at most, and the inverse at least."""
    apart: float = 1.0
    """Distance of the ring from the limb's own last joint, in its radii, at least."""
    least_vertices: int = 4
    """Vertices on either side of the ring, at least."""


def mirrored_joints(
    V: Floats,
    F: Ints,
    parts: RootedParts,
    rest: Floats,
    pairs: LimbPairs,
    is_still: Flags | None = None,
    settings: MirroredJointsSettings | None = None,
) -> list[StillJoint]:
    """Joints within the last parts of limbs that the limb's mirror image has, the innermost of each part, by part.

    A limb without any joint has none: it may hang on the trunk anywhere. Nor has a body that has a single pair of limbs.

    V, F     : (vertex, xyz) reference, mesh unit · (face, corner)
    rest     : (part, xyz) joints in the reference, mesh unit
    pairs    : ends of limbs that are mirror images
    is_still : (part,) joints that no motion shows, which say nothing of others; None has none
    """
    chosen, found = settings or MirroredJointsSettings(), dict[int, StillJoint]()
    if len(pairs.tip) < chosen.least_pairs:
        return []
    still = np.zeros(len(rest), np.bool_) if is_still is None else is_still
    edge = ring_edges(*rings(F, len(V)))
    for (tips, away), limbs in zip(zip(*pairs, strict=True), mirrored_limbs(F, parts, pairs), strict=False):
        for side, (own, other) in enumerate(((limbs.one, limbs.other), (limbs.other, limbs.one))):
            last = int(parts.place[tips[side]])
            is_end = len(own.part) > 0 and own.part[0] == last and not (parts.parents == last).any()
            if is_end and last not in found:
                for joint in _farther_out(own, other, limbs.row[:, 1 - side]):
                    part = int(other.part[joint])
                    level = _level(V, edge, parts, part, rest[part], away[1 - side])
                    if still[part] or level >= own.level.min():
                        continue
                    cut = _ring(V, edge, parts, last, away[side], level)
                    if cut is not None and _is_alike(cut, float(parts.radius[part]), rest[last], chosen):
                        found[last] = StillJoint(last, False, cut.centre, cut.radius, _nearer(cut, away[side], level))
                        break
    return [found[part] for part in sorted(found)]


def _farther_out(own: Limb, other: Limb, paired: Ints) -> Iterator[int]:
    """Joints of the other limb without a partner, nearer to its end than any joint of a limb is to its own, innermost first."""
    for joint in range(len(other.part) - 1, -1, -1):
        if joint not in paired and np.isfinite(other.level[joint]) and other.level[joint] < own.level.min():
            yield joint


def _level(V: Floats, edge: Ints, parts: RootedParts, part: int, joint: Floats, away: Floats) -> float:
    """How far a joint lies from the end of its limb: its border, and how far the joint was moved along the limb since.

    edge : (edge, 2) both ways
    away : (vertex,) from that end, mesh unit
    """
    inside = beyond(parts.parents)[part] > 0
    inner, outer = edge[~inside[parts.place[edge[:, 0]]] & inside[parts.place[edge[:, 1]]]].T
    reached = np.isfinite(away[inner]) & np.isfinite(away[outer])
    a, b = V[inner[reached]], V[outer[reached]]
    inwards = (a - b).mean(axis=0)
    inwards /= max(float(np.linalg.norm(inwards)), np.finfo(float).tiny)
    border = (a + b).mean(axis=0) / 2.0
    return float((away[inner[reached]] + away[outer[reached]]).mean() / 2.0 + (joint - border) @ inwards)


def _ring(V: Floats, edge: Ints, parts: RootedParts, part: int, away: Floats, level: float) -> EndCut | None:
    """The ring across a part at a distance from the limb's end; away (vertex,) from that end, mesh unit."""
    inside = edge[(parts.place[edge] == part).all(axis=1) & np.isfinite(away[edge]).all(axis=1)]
    own = np.flatnonzero((parts.place == part) & np.isfinite(away))
    return ring_at(V, (part, int(parts.parents[part])), own, -away, inside, -level)


def _is_alike(cut: EndCut, radius: float, joint: Floats, chosen: MirroredJointsSettings) -> bool:
    """Whether a ring is as wide as the other limb's, apart from the joint that is there, and has vertices on either side."""
    is_as_wide = cut.radius / chosen.alike <= radius <= cut.radius * chosen.alike
    is_apart = np.linalg.norm(cut.centre - joint) >= chosen.apart * cut.radius
    sides = int(cut.far.sum()), int((~cut.far).sum())
    return bool(is_as_wide and is_apart and min(sides) >= chosen.least_vertices)


def _nearer(cut: EndCut, away: Floats, level: float) -> Floats:
    """(vertex,) how much each vertex follows the piece before a ring."""
    return 1.0 - share_beyond(np.where(np.isfinite(away), level - away, -np.inf), cut.radius)
