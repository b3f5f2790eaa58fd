"""One tree of all parts by the joints between them, and how clear each joint is (2014, Sec. 6.3)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.joint_rotations import swing, widest_turning_range
from kinetree.tasks.numerics.structure.rotation_centres import (
    Borders,
    Joints,
    RotationCentresSettings,
    blend_error,
    borders,
    drift,
    rotation_centres,
)
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.spanning_tree import RootedTree, rooted, spanning


class PartTreeSettings(NamedTuple):
    """What a border costs in the spanning tree."""

    noise: float = 0.001
    """Drift that is none, share of the root of the area. Not recorded. Halved or doubled it moves no joint of two generated
    bodies; it guards the comparison of borders that do not drift at all."""
    shortness: float = 0.1
    """By what share a border costs more for every time that another border of its parts is longer. Not recorded. Halved or
    doubled it moves no joint of two generated bodies; it decides between borders that drift alike."""
    still: float = 3.0
    """Range of turning, degrees, below which a border is no joint: it is used where nothing else joins its parts. Limbs that
    move alike meet in such borders without any drift. It changes no other tree of the four cuts of 96 bodies than those
    that `parted_limbs` cuts."""
    bridge_radius: float = 0.02
    """Radius of the border made between parts that touch no other, share of the root of the area. Not recorded. Halved or
    doubled it moves no joint of two generated bodies, whose parts all touch."""
    bridge_length: float = 0.1
    """Its length, share of the root of the area. Not recorded. Halved or doubled it moves no joint of two generated bodies,
    whose parts all touch."""


class MovingSurface(NamedTuple):
    """A body's surface in motion.

    V, F  : (vertex, xyz) reference, mesh unit · (face, corner)
    x     : (frame, vertex, xyz) mesh unit
    area  : (vertex,) mesh unit²
    takes : positions of the frames of each take; None takes all as one
    """

    V: Floats
    F: Ints
    x: Floats
    area: Floats
    takes: Sequence[slice] | None = None

    @property
    def size(self) -> float:
        """Root of the area, mesh unit: what lengths are relative to."""
        return float(np.sqrt(self.area.sum()))


PartPairs = frozenset[frozenset[int]]
"""Pairs of parts, by their numbers."""


class MovingParts(NamedTuple):
    """Rigid parts, numbered without gaps.

    label    : (vertex,) part
    R, t     : (frame, part, 3, 3), (frame, part, xyz) from the reference
    residual : (frame, part) what a part's motion leaves unexplained, mesh unit
    confidence : (frame, part) 0 to 1; None where every vertex was followed
    joined     : pairs of parts at whose border the tree has a joint, if they meet, whatever their motions say
    by_shape   : those of them of which the shape of the body is evidence enough, however little they turn
    """

    label: Ints
    R: Floats
    t: Floats
    residual: Floats
    confidence: Floats | None = None
    joined: PartPairs = frozenset()
    by_shape: PartPairs = frozenset()

    def without(self, gone: int, label: Ints) -> "MovingParts":
        """The other parts; `label` (vertex,) gives the vertices of the part that is gone to others."""
        others = np.arange(self.R.shape[1]) != gone
        confidence = None if self.confidence is None else self.confidence[:, others]
        R, t, residual = (np.ascontiguousarray(a[:, others]) for a in (self.R, self.t, self.residual))
        pairs = (_renumbered(pairs, gone) for pairs in (self.joined, self.by_shape))
        return MovingParts(label - (label > gone), R, t, residual, confidence, *pairs)


def _renumbered(pairs: PartPairs, gone: int) -> PartPairs:
    """Pairs of parts as they are numbered without one."""
    return frozenset(frozenset(part - (part > gone) for part in pair) for pair in pairs if gone not in pair)


class PartTree(NamedTuple):
    """All parts in one tree.

    borders, joints : where parts meet; a centre for each border
    tree            : of the parts
    degrees         : (part,) range of turning against the parent, by place in the tree; 0 for the root
    ratio           : (part,) displacement of the smaller side by turning, in drifts of the joint; infinite for the root
                      both the largest over all frames and over each take
    """

    borders: Borders
    joints: Joints
    tree: RootedTree
    degrees: Floats
    ratio: Floats


def joints_of(found: PartTree) -> PartPairs:
    """The pairs of parts between which a tree has a joint."""
    return frozenset(map(frozenset, found.borders.pair[found.tree.border[1:]].tolist()))


def part_tree(body: MovingSurface, parts: MovingParts, settings: PartTreeSettings | None = None) -> PartTree:
    """The minimum spanning tree of all parts and a joint for each of its borders (2014, Sec. 6.3; the cost is ours).

    It takes every part as it is; which of them are parts is for `pruning` to say.
    """
    chosen = settings or PartTreeSettings()
    V, R, t, label = body.V, parts.R, parts.t, parts.label
    mass = np.bincount(label, body.area, R.shape[1]).astype(np.float64)
    met = _bridged(V, borders(V, body.F, label), label, len(mass), body.size, chosen)
    centres = rotation_centres(R, t, met.pair, met.centre, met.radius, parts.residual, parts.confidence)
    cost = _border_cost(body, parts, met, centres, chosen)
    tree = rooted(met.pair, spanning(met.pair, cost, len(mass)), mass)
    met = branch_borders(met, tree)
    centres = rotation_centres(R, t, met.pair, met.centre, met.radius, parts.residual, parts.confidence)
    degrees, ratio = np.zeros(len(mass)), np.full(len(mass), np.inf)
    N = None if parts.confidence is None else smoothed_normals(V, body.F)
    spans = score_spans(len(body.x), body.takes)
    drifts = _drifts(parts, met, centres, spans)
    for k in range(1, len(mass)):
        part, above, row = tree.order[k], tree.order[tree.parents[k]], tree.border[k]
        turns, scores = relative_rotation(R, above, part), []
        degrees[k] = widest_turning_range(turns, spans)
        for (begin, end), off in zip(spans, drifts, strict=True):
            displacements = []
            for p in (part, above):
                own = label == p
                normals = None if N is None else N[own]
                displacements.append(swing(V[own], body.area[own], centres.rest[row], turns[begin:end], p == above, normals))
            scores.append(min(displacements) / (off[row] + chosen.noise * body.size))
        ratio[k] = max(scores)
    return PartTree(met, centres, tree, degrees, ratio)


def _drifts(parts: MovingParts, met: Borders, centres: Joints, spans: Ints) -> list[Floats]:
    """Drift of every border, over each of the spans."""
    R, t, seen = parts.R, parts.t, parts.confidence
    frames = [slice(begin, end) for begin, end in spans[1:]]
    return [centres.drift, *(drift(R[f], t[f], met.pair, centres.rest, None if seen is None else seen[f]) for f in frames)]


def relative_rotation(R: Floats, above: int, part: int) -> Floats:
    """The turning of a part against the part above it.

    R       : (frame, part, 3, 3)
    returns : (frame, 3, 3) R_aboveᵀ R_part
    """
    return R[:, above].transpose(0, 2, 1) @ R[:, part]


def _border_cost(body: MovingSurface, parts: MovingParts, met: Borders, centres: Joints, chosen: PartTreeSettings) -> Floats:
    """(border,) how bad a joint it would make, mesh unit: by drift, distance from the border, bad blending, a short border.

    A border that does not turn costs more than any that does; one at which parts are joined costs nothing.
    """
    longest = np.zeros(parts.R.shape[1])
    np.maximum.at(longest, met.pair.ravel(), np.repeat(met.length, 2))
    shortness = longest[met.pair].min(axis=1) / np.maximum(met.length, np.finfo(float).tiny)
    spread = RotationCentresSettings().spread
    away = np.linalg.norm(centres.rest - met.centre, axis=1) / (spread * np.maximum(met.radius, np.finfo(float).tiny))
    blend = blend_error(body.V, body.F, body.x, parts.label, met.pair, parts.R, parts.t)
    error = centres.drift * np.hypot(1.0, away) + blend + chosen.noise * body.size
    spans = score_spans(len(body.x), body.takes)
    turns = [widest_turning_range(relative_rotation(parts.R, a, b), spans) for a, b in met.pair]
    cost: Floats = error * (1.0 + chosen.shortness * shortness)
    cost = np.where(np.array(turns) < chosen.still, cost + 2.0 * cost.max(initial=0.0), cost)
    are_joined = np.array([frozenset(pair) in parts.joined for pair in met.pair.tolist()], np.bool_)
    return np.where(are_joined, 0.0, cost)


def branch_borders(met: Borders, tree: RootedTree) -> Borders:
    """The same borders; those of the tree have become the whole closed line around the branch below them.

    A thigh that meets the other one has its hip in the middle of all that it meets, not of its border with the trunk alone.

    met, tree : all borders of the parts · the tree of some of them
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


def _bridged(V: Floats, met: Borders, label: Ints, count: int, size: float, chosen: PartTreeSettings) -> Borders:
    """The borders, and one more between the nearest vertices wherever parts touch no other part."""
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
            np.append(met.radius, chosen.bridge_radius * size),
            np.append(met.length, chosen.bridge_length * size),
        )
        of[of == of[label[v]]] = of[0]
    return met
