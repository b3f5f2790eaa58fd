"""Flesh around a tree of joints: which generalized cylinders make up a figure, and which of them blend."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.input.synth.descriptions import Joint
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.implicit import Cones


class FleshSettings(NamedTuple):
    """How limbs are given their flesh."""

    knots: int = 17
    """Radii that a limb's profile is stored as, at even steps along its axis."""
    link: float = 1.5
    """Multiple of its largest radius; a shorter limb is a link: the limbs at its two ends meet in one crease."""


_SETTINGS = FleshSettings()


@dataclass(frozen=True)
class Flesh:
    """What of a figure's surface does not depend on the pose.

    parent, child : (limb,) joints at the limb's ends; the limb moves rigidly with `parent`
    ends          : (limb, end, xyz) how far the middle of the limb lies off its two joints at rest
    neighbours    : (limb, limb) whether two limbs blend somewhere
    """

    parent: Ints
    child: Ints
    ends: Floats
    side: Floats
    table: Floats
    flat: Floats
    first: Ints
    members: Ints
    reach: Floats
    slope: float
    neighbours: Flags

    @classmethod
    def of(cls, figure: Figure) -> Flesh:
        """Radius tables, flattening and blends of a figure; the root has no limb of its own."""
        limbs = [j for j, joint in enumerate(figure.joints) if joint.parent >= 0]
        child = np.array(limbs, dtype=np.int64)
        parent = figure.parents[child]
        middle = figure.rest + figure.flesh
        D = middle[child] - middle[parent]
        length = np.linalg.norm(D, axis=1)
        table = np.array([_profile(figure.joints[j].radii) for j in limbs])
        steps = np.abs(np.diff(table, axis=1)).max(axis=1) / (length / (_SETTINGS.knots - 1))
        side = np.array([_across(figure.joints[j].side, d) for j, d in zip(limbs, D, strict=True)])
        flat = np.array([figure.joints[j].flatten for j in limbs])
        groups = _blends(parent, child, length, table)
        first = np.cumsum([0, *(len(limbs_) for _, limbs_ in groups)], dtype=np.int64)
        members = np.array([b for _, limbs_ in groups for b in limbs_], dtype=np.int64)
        reach = np.array([_reach(figure.joints[j], limbs_, j, parent, table) for j, limbs_ in groups])
        neighbours = np.eye(len(limbs), dtype=np.bool_)
        for _, limbs_ in groups:
            neighbours[np.ix_(limbs_, limbs_)] = True
        slope = float(np.sqrt(1.0 + steps.max() ** 2))
        ends = np.stack([figure.flesh[parent], figure.flesh[child]], axis=1)
        return cls(parent, child, ends, side, table, flat, first, members, reach, slope, neighbours)

    def at(self, X: Floats, G: Floats, without: Flags | None = None) -> Cones:
        """The limbs at a pose, those of `without` absent.

        X, G    : (joint, xyz) positions, (joint, 3, 3) world rotations
        without : (limb,)
        """
        side = np.einsum("bij,bj->bi", G[self.parent], self.side)
        table = self.table if without is None else np.where(without[:, None], -1e6 * self.table.max(), self.table)
        off = np.einsum("bij,bej->bei", G[self.parent], self.ends)
        A = X[self.parent] + off[:, 0]
        D = X[self.child] + off[:, 1] - A
        none = (np.zeros_like(D), np.zeros_like(D), np.zeros(len(D), np.bool_))
        return Cones(A, D, side, table, self.flat, *none, self.first, self.members, self.reach, self.slope)


def _profile(radii: tuple[float, ...]) -> Floats:
    """Smooth radius table through the given radii, level at both ends so that it meets the end balls smoothly."""
    r = np.array(radii)
    s = np.linspace(0.0, 1.0, len(r))
    tangents = np.gradient(r, s) if len(r) > 2 else np.zeros(2)
    tangents[[0, -1]] = 0.0
    smooth = CubicHermiteSpline(s, r, tangents)(np.linspace(0.0, 1.0, _SETTINGS.knots))
    return np.asarray(np.clip(smooth, r.min(), r.max()), dtype=np.float64)


def _across(side: tuple[float, float, float], D: Floats) -> Floats:
    """Unit part of `side` across the limb's axis; zero when no side is given."""
    d = D / np.linalg.norm(D)
    across = np.array(side) - np.dot(side, d) * d
    length = float(np.linalg.norm(across))
    return across / length if length > 1e-9 else np.zeros(3)


def _blends(parent: Ints, child: Ints, length: Floats, table: Floats) -> list[tuple[int, list[int]]]:
    """Limbs that blend, per joint: those that meet there, and across a short link those behind it.

    The second rule lets a thigh blend with the belly through the short link to the hip, but not with the other thigh.
    """
    ends = np.stack([parent, child], axis=1)
    short = length < _SETTINGS.link * table.max(axis=1)
    groups = []
    for j in range(int(child.max()) + 1):
        here = [int(b) for b in np.flatnonzero((ends == j).any(axis=1))]
        beyond: list[int] = []
        for b in here:
            if short[b] and len(here) > 1:
                far = ends[b].sum() - j
                beyond += [int(c) for c in np.flatnonzero((ends == far).any(axis=1)) if not short[c] and c not in here]
        if len(here) > 1:
            groups.append((j, here + beyond))
    return groups


def _reach(joint: Joint, limbs: list[int], j: int, parent: Ints, table: Floats) -> float:
    """Width of a blend: a share of the thinnest limb that meets there."""
    return joint.blend * min(float(table[b, 0] if parent[b] == j else table[b, -1]) for b in limbs)
