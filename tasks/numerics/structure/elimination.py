"""Backward elimination: parts that would not be missed are given to their neighbours, the least missed first."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.structure.part_labels import connected, neighbouring
from kinetree.tasks.numerics.structure.part_motion import fit, members, squared
from kinetree.tasks.numerics.structure.removal_cost import candidates, removal_cost

ENOUGH, MOST = 120, 250  # vertices of a part that are asked, and that it is fitted to


class Body(NamedTuple):
    """One connected surface and the ways of its vertices, in the root of its area and about its middle.

    V, N        : (vertex, xyz) · (vertex, xyz) unit normals, 0 where there is none
    F           : (face, corner)
    x           : (frame, vertex, xyz)
    weight      : (frame, vertex) belief, 0 to 1
    area        : (vertex,) summing to 1
    start, ring : neighbours of every vertex, see `rings.rings`
    """

    V: Floats
    N: Floats
    F: Ints
    x: Floats
    weight: Floats
    area: Floats
    start: Ints
    ring: Ints


class Bar(NamedTuple):
    """What a part must pass to stay; lengths in the root of the body's area, areas as shares of it.

    missed : by how much it must be missed
    noise  : how many times as much as the body is uneven it must be missed at least
    slip   : what a displacement along the surface counts against one across it, 0 to 1
    short  : length by girth of a part from which on blends explain it less, and at twice which not at all
    small  : area of a part below which its shape is that of its few triangles
    large  : area of a part from which on blends explain it less, and at twice which not at all
    least  : area of a part that must be missed √2 times as much
    loose  : how much its median vertex's own residual counts against it
    quiet  : mean squared residual that vertices have everywhere, of noise
    floor  : least mean squared residual that tells clearly rigid vertices from others
    """

    removal_cost: float = 0.0025
    noise: float = 2.5
    slip: float = 0.3
    short: float = 0.2
    small: float = 0.005
    large: float = 0.04
    least: float = 0.004
    loose: float = 1.0
    quiet: float = 0.0
    floor: float = 1e-10


@compiled
def eliminated(body: Body, bar: Bar, label: Ints, R: Floats, t: Floats) -> tuple[Ints, Floats, Floats]:
    """Drops parts until each one left passes the bar; motions of parts that inherit are fitted anew.

    label   : (vertex,) part
    R, t    : (frame, part, 3, 3) · (frame, part, xyz)
    returns : (vertex,) label · R · t, of the parts dropped too
    """
    parts = R.shape[1]
    label, R, t = label.copy(), R.copy(), t.copy()
    alive, stale, refit = np.zeros(parts, np.bool_), np.ones(parts, np.bool_), np.zeros(parts, np.bool_)
    for v in range(len(label)):
        alive[label[v]] = True
    score = np.full(parts, -np.inf)
    while True:
        near = neighbouring(label, parts, body.start, body.ring)
        worst = _least_missed(body, bar, label, R, t, near, alive, stale, score)
        if worst < 0:
            return label, R, t
        alive[worst] = False
        refit[:] = False
        _inherit(body, label, worst, near, R, t, refit)
        label = connected(label, parts, body.start, body.ring)
        fit(body.V, body.x, body.weight, body.area, label, refit, True, MOST, bar.floor, R, t)
        for p in range(parts):
            for q in range(parts):
                if near[worst, p] > 0 and (q == p or near[p, q] > 0):
                    stale[q] = True


@compiled
def _least_missed(
    body: Body, bar: Bar, label: Ints, R: Floats, t: Floats, near: Ints, alive: Flags, stale: Flags, score: Floats
) -> int:
    """The part that would be missed least, −1 if all pass the bar; writes scores.

    What was missed little before is asked first: with fewer others to explain them parts are rather missed more, so that
    most scores that went stale need not be found anew (lazy greedy choice, after Minoux 1978).
    """
    parts = len(near)
    size, rim = np.zeros(parts), rims(body.V, body.F, label, parts)
    member = np.empty(len(label), np.int64)
    for v in range(len(label)):
        size[label[v]] += body.area[v]
    while True:
        worst = -1
        for p in range(parts):
            if alive[p] and score[p] < bar.removal_cost and (worst < 0 or score[p] < score[worst]):
                worst = p
        for p in range(parts):
            if worst < 0 and alive[p] and stale[p]:
                worst = p
        if worst < 0:
            return -1
        if not stale[worst]:
            return worst
        score[worst] = _score(body, bar, label, R, t, near, size, rim[worst], worst, member)
        stale[worst] = False


@compiled
def _score(
    body: Body,
    bar: Bar,
    label: Ints,
    R: Floats,
    t: Floats,
    near: Ints,
    size: Floats,
    rim: float,
    part: int,
    member: Ints,
) -> float:
    """By how much a part would be missed: infinite without a neighbour."""
    other, touches = candidates(near, size, part)
    if touches == 0:
        return np.inf
    count = members(label, part, ENOUGH, member)
    # of a tube, area / girth² is length / girth, and its two ends are the rim
    long = _ramp(4.0 * size[part] / max(rim, 1e-12) ** 2, bar.short) * _ramp(size[part], bar.small)
    bone = max(long, _ramp(size[part], bar.large))
    fine = np.sqrt(size[part] / (size[part] + bar.least))
    quiet, asked = bar.quiet * (1.0 + 2.0 * bar.slip**2) / 3.0, member[:count]
    V, N, x, w, area = body.V, body.N, body.x, body.weight, body.area
    return fine * removal_cost(V, N, x, w, area, asked, part, other, touches, R, t, bone, bar.slip, bar.loose, quiet)


@compiled
def _inherit(body: Body, label: Ints, part: int, near: Ints, R: Floats, t: Floats, heir: Flags) -> None:
    """Gives every vertex of a part to the neighbour whose motion leaves least of its own; marks the heirs."""
    for v in range(len(label)):
        if label[v] != part:
            continue
        best, least = -1, np.inf
        for p in range(len(near)):
            if near[part, p] > 0:
                left = 0.0
                for f in range(body.x.shape[0]):
                    left += body.weight[f, v] * squared(body.V, body.x, R, t, v, f, p)
                if left < least:
                    best, least = p, left
        label[v] = best
        heir[best] = True


@compiled
def _ramp(value: float, begin: float) -> float:
    """0 up to `begin`, 1 from twice that on."""
    return min(max(value / begin - 1.0, 0.0), 1.0)


@compiled
def rims(V: Floats, F: Ints, label: Ints, parts: int) -> Floats:
    """(part,) length of every part's border, half-way between the vertices on its two sides, mesh unit."""
    out = np.zeros(parts)
    for f in range(len(F)):
        for i in range(3):
            a, b, c = F[f, i], F[f, (i + 1) % 3], F[f, (i + 2) % 3]
            if label[a] == label[b] and label[c] != label[a]:
                half = 0.5 * np.sqrt((V[a, 0] - V[b, 0]) ** 2 + (V[a, 1] - V[b, 1]) ** 2 + (V[a, 2] - V[b, 2]) ** 2)
                out[label[a]] += half
                out[label[c]] += half
    return out
