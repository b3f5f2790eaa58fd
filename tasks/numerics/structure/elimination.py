"""Backward elimination: the part that costs least to remove is given to its neighbours, until none is cheap (ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.structure.part_labels import border_edges, connected
from kinetree.tasks.numerics.structure.part_motion import fit, members, squared_distance
from kinetree.tasks.numerics.structure.removal_cost import candidates, removal_cost


class NormalisedBody(NamedTuple):
    """One connected surface and the trajectories of its vertices, in the root of its area and about its middle.

    V, N        : (vertex, xyz) · (vertex, xyz) unit normals, 0 where there is none
    F           : (face, corner)
    x           : (frame, vertex, xyz)
    weight      : (frame, vertex) confidence, 0 to 1
    area        : (vertex,) summing to 1
    start, ring : neighbours of every vertex, see `neighbours.rings`
    spans       : (span, 2) frames over which costs are measured, see `score_spans`
    """

    V: Floats
    N: Floats
    F: Ints
    x: Floats
    weight: Floats
    area: Floats
    start: Ints
    ring: Ints
    spans: Ints


class EliminationSettings(NamedTuple):
    """What a part must cost to stay; lengths are shares of the root of the body's area, areas shares of it."""

    removal_cost: float
    """Removal cost of a part that stays, at least. Chosen on 21 sequences with 305 joints: 281 found with 9 spurious ones; at
    0.002 284 with 12, at 0.003 281 with 7 and one lost on a recorded human."""
    noise: float = 2.5
    """The same as a multiple of the body's unevenness, where that is more: cloth and bad alignment. Not recorded."""
    slip: float = 0.3
    """Share of a displacement along the surface that counts, where aligned vertices may slide. Chosen on generated humans and
    recorded bodies: at 0.6 a recorded wolf had five spurious joints, at 0.3 three."""
    short: float = 0.2
    """Length by girth of a part from which on blends of its neighbours explain it less, and at twice which not at all. Not
    recorded."""
    small: float = 0.005
    """Area of a part below which its shape is only that of its few triangles. Not recorded."""
    large: float = 0.04
    """Area of a part from which on blends explain it less, and at twice which not at all. Not recorded; with blends for larger
    parts humans and quadrupeds lost one joint each."""
    penalised: float = 0.004
    """Area of a part that must cost √2 times as much. Not recorded."""
    own_residual: float = 1.0
    """Share of its median vertex's own residual that is taken off a part's cost. Not recorded."""
    noise_square: float = 0.0
    """Mean squared residual that all vertices have, of noise; measured on the body, see `rigid_parts`."""
    floor: float = 1e-10
    """Least mean squared residual that separates clearly rigid vertices from others; keeps weights finite."""
    cost_vertices: int = 120
    """Vertices at which a part's cost is measured, at most. Not recorded; for time only."""
    fit_vertices: int = 250
    """Vertices that a part's motion is fitted to, at most. Not recorded; for time only."""


class Elimination(NamedTuple):
    """What is left, and what was removed in which order.

    label   : (vertex,) part
    R, t    : (frame, part, 3, 3) · (frame, part, xyz), also of the parts that were removed
    removed : (removal,) parts in the order of their removal
    cost    : (removal,) what removing each cost, root of the area
    """

    label: Ints
    R: Floats
    t: Floats
    removed: Ints
    cost: Floats


def eliminated(body: NormalisedBody, label: Ints, R: Floats, t: Floats, settings: EliminationSettings) -> Elimination:
    """Removes parts, the cheapest first, until each one left costs enough; motions of parts that inherit are fitted anew.

    label : (vertex,) part
    R, t  : (frame, part, 3, 3) · (frame, part, xyz)
    """
    return Elimination(*_eliminated(body, settings, label, R, t))


@compiled
def _eliminated(
    body: NormalisedBody, settings: EliminationSettings, label: Ints, R: Floats, t: Floats
) -> tuple[Ints, Floats, Floats, Ints, Floats]:
    """The fields of `Elimination`."""
    parts = R.shape[1]
    label, R, t = label.copy(), R.copy(), t.copy()
    alive, stale, refit = np.zeros(parts, np.bool_), np.ones(parts, np.bool_), np.zeros(parts, np.bool_)
    for v in range(len(label)):
        alive[label[v]] = True
    cost = np.full(parts, -np.inf)
    removed, removed_at = np.empty(parts, np.int64), np.empty(parts)
    count = 0
    while True:
        near = border_edges(label, parts, body.start, body.ring)
        cheapest = _cheapest(body, settings, label, R, t, near, alive, stale, cost)
        if cheapest < 0:
            return label, R, t, removed[:count], removed_at[:count]
        alive[cheapest] = False
        removed[count], removed_at[count] = cheapest, cost[cheapest]
        count += 1
        refit[:] = False
        _inherited(body, label, cheapest, near, R, t, refit)
        label = connected(label, parts, body.start, body.ring)
        fit(body.V, body.x, body.weight, body.area, label, refit, True, settings.fit_vertices, settings.floor, R, t)
        for p in range(parts):
            for q in range(parts):
                if near[cheapest, p] > 0 and (q == p or near[p, q] > 0):
                    stale[q] = True


@compiled
def _cheapest(
    body: NormalisedBody,
    settings: EliminationSettings,
    label: Ints,
    R: Floats,
    t: Floats,
    near: Ints,
    alive: Flags,
    stale: Flags,
    cost: Floats,
) -> int:
    """The part that costs least to remove, −1 if all cost enough; writes costs.

    The part that was cheapest before is measured first: with fewer others to explain it a part rather costs more, so that
    most costs that went stale need not be measured anew (lazy greedy choice, after Minoux 1978).
    """
    parts = len(near)
    size, rim = np.zeros(parts), rims(body.V, body.F, label, parts)
    member = np.empty(len(label), np.int64)
    for v in range(len(label)):
        size[label[v]] += body.area[v]
    while True:
        cheapest = -1
        for p in range(parts):
            if alive[p] and cost[p] < settings.removal_cost and (cheapest < 0 or cost[p] < cost[cheapest]):
                cheapest = p
        for p in range(parts):
            if cheapest < 0 and alive[p] and stale[p]:
                cheapest = p
        if cheapest < 0:
            return -1
        if not stale[cheapest]:
            return cheapest
        cost[cheapest] = part_cost(body, settings, label, R, t, near, size, rim[cheapest], cheapest, member)
        stale[cheapest] = False


@compiled
def part_cost(
    body: NormalisedBody,
    settings: EliminationSettings,
    label: Ints,
    R: Floats,
    t: Floats,
    near: Ints,
    size: Floats,
    rim: float,
    part: int,
    member: Ints,
) -> float:
    """What removing a part costs, root of the area: infinite without a neighbour.

    label, R, t : as in `eliminated`
    near        : (part, part) see `part_labels.border_edges`
    size, rim   : (part,) area · length of the part's border, see `rims`
    member      : (vertex,) written
    """
    other, touches = candidates(near, size, part)
    if touches == 0:
        return np.inf
    count = members(label, part, settings.cost_vertices, member)
    # of a tube, area / girth² is length / girth, and its two ends are the rim
    long = _ramp(4.0 * size[part] / max(rim, 1e-12) ** 2, settings.short) * _ramp(size[part], settings.small)
    bone = max(long, _ramp(size[part], settings.large))
    fine = np.sqrt(size[part] / (size[part] + settings.penalised))
    slip, loose = settings.slip, settings.own_residual
    quiet, sampled = settings.noise_square * (1.0 + 2.0 * slip**2) / 3.0, member[:count]
    V, N, x, w, area = body.V, body.N, body.x, body.weight, body.area
    return fine * removal_cost(V, N, x, w, area, sampled, part, other, touches, R, t, bone, slip, loose, quiet, body.spans)


@compiled
def _inherited(body: NormalisedBody, label: Ints, part: int, near: Ints, R: Floats, t: Floats, heir: Flags) -> None:
    """Gives every vertex of a part to the neighbour whose motion is nearest to its own; marks the heirs."""
    for v in range(len(label)):
        if label[v] != part:
            continue
        best, least = -1, np.inf
        for p in range(len(near)):
            if near[part, p] > 0:
                total = 0.0
                for f in range(body.x.shape[0]):
                    total += body.weight[f, v] * squared_distance(body.V, body.x, R, t, v, f, p)
                if total < least:
                    best, least = p, total
        label[v] = best
        heir[best] = True


@compiled
def _ramp(value: float, begin: float) -> float:
    """0 up to `begin`, 1 from twice that on."""
    return min(max(value / begin - 1.0, 0.0), 1.0)


@compiled
def rims(V: Floats, F: Ints, label: Ints, parts: int) -> Floats:
    """Length of every part's border, half-way between the vertices on its two sides.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    label   : (vertex,) part, below `parts`
    returns : (part,) mesh unit
    """
    out = np.zeros(parts)
    for f in range(len(F)):
        for i in range(3):
            a, b, c = F[f, i], F[f, (i + 1) % 3], F[f, (i + 2) % 3]
            if label[a] == label[b] and label[c] != label[a]:
                half = 0.5 * np.sqrt((V[a, 0] - V[b, 0]) ** 2 + (V[a, 1] - V[b, 1]) ** 2 + (V[a, 2] - V[b, 2]) ** 2)
                out[label[a]] += half
                out[label[c]] += half
    return out
