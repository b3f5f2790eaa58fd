"""Parts that hold two bones, cut once more: where both halves are parts, and their joint lies far from all others (ours).

The elimination gives a bone away piece by piece: each piece by itself costs little, so that the whole bone may go.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.structure.elimination import EliminationSettings, NormalisedBody, part_cost, rims
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.oversegmentation import grouped
from kinetree.tasks.numerics.structure.part_labels import border_edges, connected, relabelled
from kinetree.tasks.numerics.structure.part_motion import fit, residuals
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree, part_tree


class HalvedPartsSettings(NamedTuple):
    """What makes both halves of a part parts."""

    cost: float = 0.75
    """Removal cost of each half, at least, share of that of a part that stays. Chosen on people, humans and quadrupeds of even
    seeds: true halves far from other joints have 0.79 to 1.02, false ones 0.66 and less."""
    degrees: float = 6.0
    """Range by which their joint turns, at least: that of `PruningSettings`."""
    ratio: float = 1.25
    """Displacement by turning in drifts of their joint, at least: what pruning asks of a last part that has a leaf."""
    length: float = 1.25
    """Distance of their joint from every other joint of the two, at least, in radii of their border; nearer, the halves share
    out the flesh of a joint that is there. On the same bodies true ones lie at 1.75 to 3.7, false ones that cost enough at
    1.16 at most."""
    rounds: int = 2
    """Rounds of labels and motions of the two halves."""
    frames: int = 36
    """Frames, evenly many, by which the halves are told apart, at most; for time. They are judged by all."""


def halved(
    body: NormalisedBody,
    patch: Ints,
    label: Ints,
    R: Floats,
    t: Floats,
    limits: EliminationSettings,
    steps: int,
    settings: HalvedPartsSettings | None = None,
) -> tuple[Ints, Floats, Floats, Ints]:
    """The parts, those that hold two bones as two.

    patch   : (vertex,) see `oversegmentation.patches`
    label   : (vertex,) part
    R, t    : (frame, part, 3, 3) · (frame, part, xyz)
    limits  : of the elimination before
    steps   : see `relabelled`
    returns : label, R and t with the new halves as the last parts · (part,) the part that each was
    """
    chosen, origin = settings or HalvedPartsSettings(), list(range(R.shape[1]))
    for part in range(R.shape[1]):
        second = _second_half(body, patch, label == part, limits, steps, chosen)
        if not second.any():
            continue
        new = R.shape[1]
        tried, turned, moved = np.where(second, new, label), _with_room(R), _with_room(t)
        both = np.isin(np.arange(new + 1), (part, new))
        fit(body.V, body.x, body.weight, body.area, tried, both, False, limits.fit_vertices, limits.floor, turned, moved)
        costs = _costs(body, tried, turned, moved, limits, (part, new))
        if min(costs) >= chosen.cost * limits.removal_cost and _have_own_joint(body, tried, turned, moved, part, chosen):
            fit(body.V, body.x, body.weight, body.area, tried, both, True, len(tried), limits.floor, turned, moved)
            label, R, t = tried, turned, moved
            origin.append(part)
    return label, R, t, np.array(origin)


def _with_room(motion: Floats) -> Floats:
    """The motions of all parts and of one more, (frame, part + 1, …)."""
    return np.concatenate([motion, motion[:, :1]], axis=1)


def _second_half(
    body: NormalisedBody, patch: Ints, part: Flags, limits: EliminationSettings, steps: int, chosen: HalvedPartsSettings
) -> Flags:
    """(vertex,) one of the two groups of a part's patches that move most nearly as one each; nothing if it has no two."""
    own, number = np.flatnonzero(part), np.cumsum(part) - 1
    faces = number[body.F[part[body.F].all(axis=1)]]
    start, ring = rings(faces, len(own))
    some = np.ix_(np.unique(np.linspace(0, len(body.x) - 1, chosen.frames).round().astype(np.int64)), own)
    V, x, weight, area = body.V[own], body.x[some], body.weight[some], body.area[own]
    half = grouped(V, x, weight * area, patch[own], np.zeros(len(own), np.int64), start, ring, 2, np.inf)
    R, t = np.empty((len(x), 2, 3, 3)), np.empty((len(x), 2, 3))
    for turn in range(chosen.rounds + 1):
        if turn > 0:
            fit(V, x, weight, area, half, np.ones(2, np.bool_), False, limits.fit_vertices, limits.floor, R, t)
            half = relabelled(V, x, weight, R, t, half, start, ring, steps)
        half = connected(half, 2, start, ring) if half.max() == 1 else half
        if half.max() != 1 or half.min() != 0:
            return np.zeros(len(part), np.bool_)
    second = np.zeros(len(part), np.bool_)
    second[own[half == 1]] = True
    return second


def _costs(
    body: NormalisedBody, label: Ints, R: Floats, t: Floats, limits: EliminationSettings, of: tuple[int, ...]
) -> list[float]:
    """What removing each of some parts costs."""
    parts, member = R.shape[1], np.empty(len(label), np.int64)
    near, rim = border_edges(label, parts, body.start, body.ring), rims(body.V, body.F, label, parts)
    size = np.bincount(label, body.area, parts).astype(np.float64)
    return [float(part_cost(body, limits, label, R, t, near, size, rim[p], p, member)) for p in of]


def _have_own_joint(body: NormalisedBody, label: Ints, R: Floats, t: Floats, part: int, chosen: HalvedPartsSettings) -> bool:
    """Whether the last part and another one meet in a joint that turns, drifts little and lies far from their other joints."""
    parts, frames = R.shape[1], len(body.x)
    given = bool((body.weight == 1.0).all())
    certain = None if given else confident_share(label, body.area, body.weight, frames, parts)
    left = residuals(body.V, body.x, body.weight * body.area, R, t, label)
    takes = [slice(int(begin), int(end)) for begin, end in body.spans[1:]] or None
    tree = part_tree(MovingSurface(body.V, body.F, body.x, body.area, takes), MovingParts(label, R, t, left, certain))
    place = {int(p): k for k, p in enumerate(tree.tree.order)}
    low, high = max(place[part], place[parts - 1]), min(place[part], place[parts - 1])
    if tree.tree.parents[low] != high:
        return False
    turns = tree.degrees[low] >= chosen.degrees and tree.ratio[low] >= chosen.ratio
    return bool(turns and _distance_of_others(tree, low, high) >= chosen.length)


def _distance_of_others(found: PartTree, low: int, high: int) -> float:
    """How far the nearest other joint of two neighbours in the tree lies from theirs, in radii of their border."""
    tree, rest = found.tree, found.joints.rest
    k = np.arange(1, len(tree.order))
    others = k[(k != low) & (np.isin(k, (low, high)) | np.isin(tree.parents[1:], (low, high)))]
    apart = np.linalg.norm(rest[tree.border[others]] - rest[tree.border[low]], axis=1)
    return float(apart.min(initial=np.inf) / max(found.borders.radius[tree.border[low]], np.finfo(float).tiny))
