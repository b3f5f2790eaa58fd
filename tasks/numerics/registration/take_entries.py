"""By which frame a take is entered: the one whose limbs lie most as in a frame of a take that is reached already (ours).

Which limb is which is not known from take to take, and the body may stand elsewhere and face another way. So limbs are
assigned and the body is turned together, from several directions; a first look compares lengths that no turning changes. A body
is much like itself turned back to front. So an entry has all the motions that bring limbs near, and the surface decides.
"""

from collections.abc import Sequence
from itertools import permutations, product
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion


class TakeEntriesSettings(NamedTuple):
    """How poses of two takes are compared; lengths are shares of the root of the area."""

    looked_at: int = 40
    """Pairs of frames that are compared by points, after the first look. Not varied."""
    rounds: int = 3
    """Rounds of assigning limbs and turning. Not varied."""
    missing: float = 0.5
    """Distance that counts for a limb that only one of the two frames has. Not varied."""
    apart: float = float(np.radians(45.0))
    """Two motions are told apart from this difference of their rotations, radians. Not varied."""
    likely: float = 0.15
    """Motions count that leave at most so much more distance than the best. Not varied."""
    starts: int = 4
    """Motions of one entry at most. Not varied."""


class Limbs(NamedTuple):
    """stems (limb, station, xyz) from root to tip and centre (xyz) in mesh unit, size the root of the area."""

    stems: Floats
    centre: Floats
    size: float


class Entry(NamedTuple):
    """How a take is entered.

    at, before : positions of its first frame to be reached and of the frame before it
    rotation   : (start, 3, 3) R of the likely motions from the latter to it, the likeliest first
    shift      : (start, xyz) x there = R x + shift, mesh unit
    distance   : (start,) between points on limbs, share of the size
    """

    at: int
    before: int
    rotation: Floats
    shift: Floats
    distance: Floats


def take_entries(limbs: Sequence[Limbs], takes: Sequence[slice], reference: int) -> list[Entry]:
    """An entry for every take but that of the reference, always the take next whose pose is nearest.

    limbs     : (frame,)
    takes     : positions of the frames of each take
    reference : position of the reference frame
    """
    reached = [t for span in takes if span.start <= reference < span.stop for t in range(span.start, span.stop)]
    left = [list(range(span.start, span.stop)) for span in takes if not span.start <= reference < span.stop]
    entries = []
    while left:
        best = [nearest(limbs, reached, frames) for frames in left]
        k = int(np.argmin([entry.distance[0] for entry in best]))
        entries.append(best[k])
        reached += left.pop(k)
    return entries


def nearest(limbs: Sequence[Limbs], reached: Sequence[int], frames: Sequence[int]) -> Entry:
    """The pair of a frame that is reached and one of the others whose limbs lie most alike.

    reached, frames : positions
    """
    settings = TakeEntriesSettings()
    pairs = sorted(product(reached, frames), key=lambda pair: _unlikeness(limbs[pair[0]], limbs[pair[1]], settings))
    found = []
    for a, b in pairs[: settings.looked_at]:
        R, distance = likely_turns(limbs[a], limbs[b])
        found.append(Entry(b, a, R, limbs[b].centre - R @ limbs[a].centre, distance))
    return min(found, key=lambda entry: float(entry.distance[0]))


def likely_turns(a: Limbs, b: Limbs) -> tuple[Floats, Floats]:
    """The rotations from one pose to the other about their centres that leave little distance between limbs.

    returns : (start, 3, 3) the likeliest first · (start,) mean distance that is left, share of the size
    """
    settings = TakeEntriesSettings()
    A, B = ((limbs.stems - limbs.centre) / limbs.size for limbs in (a, b))
    if not len(A) or not len(B):
        return np.eye(3)[None], np.array([settings.missing * max(len(A), len(B))])
    tried = sorted((_turned(A, B, start, settings) for start in _STARTS), key=lambda one: one[1])
    kept: list[tuple[Floats, float]] = []
    for R, distance in tried:
        is_new = all(_between(R, other) > settings.apart for other, _ in kept)
        if is_new and len(kept) < settings.starts and distance <= tried[0][1] + settings.likely:
            kept.append((R, distance))
    return np.stack([R for R, _ in kept]), np.array([distance for _, distance in kept])


def _between(R: Floats, S: Floats) -> float:
    """Angle between two rotations, radians."""
    return float(np.arccos(np.clip((np.sum(R * S) - 1.0) / 2.0, -1.0, 1.0)))


def _turned(A: Floats, B: Floats, R: Floats, settings: TakeEntriesSettings) -> tuple[Floats, float]:
    """The rotation near R that brings A nearest to B, and how near."""
    apart = abs(len(A) - len(B)) * settings.missing
    for _ in range(settings.rounds):
        away = np.linalg.norm((A @ R.T)[:, None] - B[None], axis=3).mean(axis=2)
        i, j = linear_sum_assignment(away)
        R = rigid_motion(
            np.concatenate([A[i].reshape(-1, 3), np.zeros((1, 3))]), np.concatenate([B[j].reshape(-1, 3), np.zeros((1, 3))])
        )[0]
    left = np.linalg.norm(A[i] @ R.T - B[j], axis=2).mean(axis=1).sum()
    return R, float((left + apart) / max(len(A), len(B)))


def _unlikeness(a: Limbs, b: Limbs, settings: TakeEntriesSettings) -> float:
    """How differently tips lie to each other and to the roots of their limbs, whatever the place and direction."""
    if len(a.stems) != len(b.stems):
        return settings.missing * abs(len(a.stems) - len(b.stems))
    return float(np.abs(unturned(a) - unturned(b)).mean()) if len(a.stems) else 0.0


def unturned(limbs: Limbs) -> Floats:
    """What no turning changes: sorted distances between tips, then sorted lengths of limbs, share of the size."""
    tips, roots = limbs.stems[:, -1], limbs.stems[:, 0]
    i, j = np.triu_indices(len(tips), 1)
    between = np.sort(np.linalg.norm(tips[i] - tips[j], axis=1))
    return np.concatenate([between, np.sort(np.linalg.norm(tips - roots, axis=1))]) / limbs.size


def _quarter_turns() -> list[Floats]:
    """The 24 rotations that carry a cube into itself, no rotation first."""
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            R = np.zeros((3, 3))
            R[np.arange(3), order] = signs
            if np.linalg.det(R) > 0:
                found.append(R)
    return sorted(found, key=lambda R: -float(np.trace(R)))


_STARTS = _quarter_turns()
