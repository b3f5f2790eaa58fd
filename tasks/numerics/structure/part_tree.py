"""All parts hung in one tree by the joints between them, and what speaks for each joint (2014, Sec. 6.3)."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.joint_rotations import swing, turning_range
from kinetree.tasks.numerics.structure.rotation_centres import SPREAD, Borders, Joints, blend_error, borders, rotation_centres
from kinetree.tasks.numerics.structure.spanning_tree import Tree, rooted, spanning

NOISE = 0.001
"""Drift that is none, share of the root of the area."""
SHORT = 0.1
"""How much a border costs for every time that another one of its parts is longer."""


class Surfaces(NamedTuple):
    """A body's surface in motion: V (vertex, xyz), F (face, corner), x (frame, vertex, xyz), area (vertex,), mesh unit."""

    V: Floats
    F: Ints
    x: Floats
    area: Floats

    @property
    def size(self) -> float:
        """Root of the area, mesh unit: what lengths are relative to."""
        return float(np.sqrt(self.area.sum()))


class Carried(NamedTuple):
    """Rigid parts, numbered without gaps.

    label    : (vertex,) part
    R, t     : (frame, part, 3, 3), (frame, part, xyz) from the reference
    residual : (frame, part) what a part's motion leaves unexplained, mesh unit
    trust    : (frame, part) how much each part is to be believed in each frame; None where every vertex was followed
    """

    label: Ints
    R: Floats
    t: Floats
    residual: Floats
    trust: Floats | None = None

    def without(self, gone: int, label: Ints) -> "Carried":
        """The others, after the vertices of the one that is gone were given the labels of others."""
        kept = np.arange(self.R.shape[1]) != gone
        trust = None if self.trust is None else self.trust[:, kept]
        R, t, residual = (np.ascontiguousarray(a[:, kept]) for a in (self.R, self.t, self.residual))
        return Carried(label - (label > gone), R, t, residual, trust)


class PartTree(NamedTuple):
    """All parts in one tree.

    borders, joints : where parts meet; a centre for each border
    tree            : of the parts
    degrees         : (part,) range of turning against the parent, by place in the tree; 0 for the root
    ratio           : (part,) what turning moves the smaller side by against what the joint drifts by; infinite for the root
    """

    borders: Borders
    joints: Joints
    tree: Tree
    degrees: Floats
    ratio: Floats


def part_tree(body: Surfaces, parts: Carried) -> PartTree:
    """The tree of all parts, without a look at which of them deserve to be parts."""
    V, R, t, label = body.V, parts.R, parts.t, parts.label
    mass = np.bincount(label, body.area, R.shape[1]).astype(np.float64)
    met = _joined(V, borders(V, body.F, label), label, len(mass), body.size)
    centres = rotation_centres(R, t, met.pair, met.centre, met.radius, parts.residual, parts.trust)
    cost = _cost(body, parts, met, centres)
    tree = rooted(met.pair, spanning(met.pair, cost, len(mass)), mass)
    met = branch_borders(met, tree)
    centres = rotation_centres(R, t, met.pair, met.centre, met.radius, parts.residual, parts.trust)
    degrees, ratio = np.zeros(len(mass)), np.full(len(mass), np.inf)
    N = None if parts.trust is None else smoothed_normals(V, body.F)
    for k in range(1, len(mass)):
        part, above, row = tree.order[k], tree.order[tree.parents[k]], tree.border[k]
        turns = against(R, above, part)
        degrees[k] = turning_range(turns)
        ways = []
        for p in (part, above):
            mine = label == p
            ways.append(swing(V[mine], body.area[mine], centres.rest[row], turns, p == above, None if N is None else N[mine]))
        ratio[k] = min(ways) / (centres.drift[row] + NOISE * body.size)
    return PartTree(met, centres, tree, degrees, ratio)


def against(R: Floats, above: int, part: int) -> Floats:
    """(frame, 3, 3) R_pᵀ R_a: the turning of a part a against the part p above it, from R (frame, part, 3, 3)."""
    return R[:, above].transpose(0, 2, 1) @ R[:, part]


def _cost(body: Surfaces, parts: Carried, met: Borders, centres: Joints) -> Floats:
    """(border,) how ill a joint it would make: drift, being far from the border, blending ill, being a short border."""
    longest = np.zeros(parts.R.shape[1])
    np.maximum.at(longest, met.pair.ravel(), np.repeat(met.length, 2))
    shortness = longest[met.pair].min(axis=1) / np.maximum(met.length, np.finfo(float).tiny)
    away = np.linalg.norm(centres.rest - met.centre, axis=1) / (SPREAD * np.maximum(met.radius, np.finfo(float).tiny))
    blend = blend_error(body.V, body.F, body.x, parts.label, met.pair, parts.R, parts.t)
    cost: Floats = (centres.drift * np.hypot(1.0, away) + blend + NOISE * body.size) * (1.0 + SHORT * shortness)
    return cost


def branch_borders(met: Borders, tree: Tree) -> Borders:
    """The same borders; those of the tree have become the whole closed line around what hangs on them.

    A thigh that meets the other one has its hip in the middle of all that it meets, not of its border with the trunk alone.
    """
    count = len(tree.order)
    place = np.empty(count, dtype=np.int64)
    place[tree.order] = np.arange(count)
    below = beyond(tree.parents) > 0
    centre, radius = met.centre.copy(), met.radius.copy()
    for k in range(1, count):
        a, b = below[k, place[met.pair]].T
        w, c, r = met.length[a != b], met.centre[a != b], met.radius[a != b]
        middle = w @ c / w.sum()
        row = tree.border[k]
        centre[row], radius[row] = middle, np.sqrt(w @ (r**2 + ((c - middle) ** 2).sum(axis=1)) / w.sum())
    return met._replace(centre=centre, radius=radius)


def _joined(V: Floats, met: Borders, label: Ints, count: int, size: float) -> Borders:
    """The borders, and one more between the nearest vertices wherever parts would hang on nothing."""
    of = np.arange(count)
    for a, b in met.pair:
        of[of == max(of[a], of[b])] = min(of[a], of[b])
    while (of != of[0]).any():
        near, far = np.flatnonzero(of[label] == of[0]), np.flatnonzero(of[label] != of[0])
        apart, row = KDTree(V[near]).query(V[far])
        k = int(np.argmin(apart))
        u, v = near[row[k]], far[k]
        pair = np.sort(label[[u, v]])
        met = Borders(
            np.concatenate([met.pair, pair[None]]),
            np.concatenate([met.centre, (V[u] + V[v])[None] / 2]),
            np.append(met.radius, 0.02 * size),
            np.append(met.length, 0.1 * size),
        )
        of[of == of[label[v]]] = of[0]
    return met
