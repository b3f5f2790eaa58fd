"""Which way is up, by where leaves come to stand (ours)."""

from typing import Literal, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats

DIRECTIONS: tuple[Literal["x", "y", "z", "-x", "-y", "-z"], ...] = ("x", "y", "z", "-x", "-y", "-z")
"""Directions that may be up."""


class UpDirectionSettings(NamedTuple):
    """What makes a direction look like up. Where chosen: not recorded; not varied so far."""

    expected: tuple[float, ...] = (0.4, 1.0, 1.0, 0.4, 0.7, 0.6)
    """How far conventions expect each of `DIRECTIONS`: files have y or z up, images y down."""
    ground: float = 0.06
    """A leaf stands on the ground within this share of the size."""
    with_lowest: float = 0.08
    """A leaf is with the lowest of its frame within this share of the size."""
    lowest: float = 0.1
    """Quantile, over frames, of the lowest leaf that is taken for the ground."""
    opposite: float = 0.3
    """Share of the opposite's score taken from a direction's: the sides of a body are alike, its feet and head are not."""


class Direction(NamedTuple):
    """The row of `DIRECTIONS`, and by what share no other is as good."""

    direction: int
    confidence: float


def up_direction(X: Floats, settings: UpDirectionSettings | None = None) -> Direction:
    """The direction for which most leaves stand on one level, the ground, along an axis on which leaves spread  (ours).

    The ground is the level of the lowest leaves over all frames, so that a hand at rest far above it counts for nothing.
    What also holds of the opposite direction speaks against both.

    X       : (leaf, frame, xyz) mesh unit; NaN where one is not seen
    returns : y with confidence 0 where fewer than two leaves are seen together
    """
    chosen = settings or UpDirectionSettings()
    is_seen = np.isfinite(X[:, :, 0])
    X, is_seen = X[:, is_seen.sum(axis=0) > 1], is_seen[:, is_seen.sum(axis=0) > 1]
    if not X.size:
        return Direction(1, 0.0)
    reach = np.nanmax(X, axis=0) - np.nanmin(X, axis=0)
    size = float(np.median(np.linalg.norm(reach, axis=1)))
    if size == 0.0:
        return Direction(1, 0.0)
    spread = np.median(reach, axis=0) / size
    heights = [sign * X[:, :, a] / size for sign in (1.0, -1.0) for a in range(3)]
    stand = np.array([_standing(height, is_seen, chosen) for height in heights]) * np.tile(spread, 2)
    score = np.array(chosen.expected) * (stand - chosen.opposite * np.roll(stand, 3))
    best, second = np.argsort(-score, kind="stable")[:2]
    return Direction(int(best), float(np.clip(1.0 - score[second] / score[best], 0.0, 1.0)) if score[best] > 0.0 else 0.0)


def _standing(height: Floats, is_seen: Flags, settings: UpDirectionSettings) -> float:
    """Share of the leaves (leaf, frame) on the ground, plus that of those with the lowest of their frame."""
    lowest = np.nanmin(height, axis=0)
    on_ground = height - np.quantile(lowest, settings.lowest) < settings.ground
    with_lowest = height - lowest < settings.with_lowest
    return float(on_ground[is_seen].mean() + with_lowest[is_seen].mean())
