"""Which way is up, by where the ends of limbs come to stand (ours)."""

from typing import Literal, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats

DIRECTIONS: tuple[Literal["x", "y", "z", "-x", "-y", "-z"], ...] = ("x", "y", "z", "-x", "-y", "-z")
"""Directions that may be up."""
USUAL = np.array([0.4, 1.0, 1.0, 0.4, 0.7, 0.6])
"""How far conventions expect each: files have y or z up, images y down."""
GROUND, LOWEST = 0.06, 0.08
"""A tip is on the ground, or with the lowest of its frame, within this share of the size."""


class Direction(NamedTuple):
    """The row of `DIRECTIONS`, and by what share no other is as good."""

    direction: int
    confidence: float


def up_direction(X: Floats) -> Direction:
    """The direction against which most tips come to one level, below which none goes, along an axis on which they spread.

    The level is that of the lowest tips over all frames, so that a hand at rest far below another counts for nothing.
    What also holds of the opposite direction speaks against both: the sides of a body are alike, its feet and head are not.

    X       : (leaf, frame, xyz) tips, mesh unit; NaN where one is not seen
    returns : y with confidence 0 where fewer than two tips are seen together
    """
    seen = np.isfinite(X[:, :, 0])
    X, seen = X[:, seen.sum(axis=0) > 1], seen[:, seen.sum(axis=0) > 1]
    if not X.size:
        return Direction(1, 0.0)
    reach = np.nanmax(X, axis=0) - np.nanmin(X, axis=0)
    size = float(np.median(np.linalg.norm(reach, axis=1)))
    if size == 0.0:
        return Direction(1, 0.0)
    spread = np.median(reach, axis=0) / size
    stand = np.array([_standing(sign * X[:, :, a] / size, seen) * spread[a] for sign in (1.0, -1.0) for a in range(3)])
    score = USUAL * (stand - 0.3 * np.roll(stand, 3))
    best, second = np.argsort(-score, kind="stable")[:2]
    return Direction(int(best), float(np.clip(1.0 - score[second] / score[best], 0.0, 1.0)) if score[best] > 0.0 else 0.0)


def _standing(height: Floats, seen: Flags) -> float:
    """Share of the tips on the ground, and of those with the lowest of their frame."""
    lowest = np.nanmin(height, axis=0)
    on_ground = height - np.quantile(lowest, 0.1) < GROUND
    with_lowest = height - lowest < LOWEST
    return float(on_ground[seen].mean() + with_lowest[seen].mean())
