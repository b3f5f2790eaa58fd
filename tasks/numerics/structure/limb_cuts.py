"""Rings across the limbs of a pair that are one part with what they hang on: in a bow pelvis and both thighs are (ours).

Thighs that move alike and are most of such a part say how it moves, and the pelvis goes along. Rings across both lie at the
same distance from the ends of the legs. While a ring across one thigh is judged the other thigh does not count: it moves as the
first, and would hold the pelvis.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.end_cuts import EndCut, EndCutsSettings, is_wide, ring_at
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs

TINY = np.finfo(float).tiny


class LimbCutsSettings(NamedTuple):
    """When a part holds both limbs of a pair, and which rings are proposed.

    Chosen on people 6, 14, 62 and 102, who bow: their pelvises hold 0.25 to 0.35 of themselves on each limb, and the best ring
    of each shows 0.059 to 0.223. Of 93 other bodies (people 0 to 14, 55 to 69, 100 to 114, humans, four-legged and random trees
    0 to 9, recorded ones, eighteen clips of a rigged body) one has such a part, between the arms of person 8, whose rings show
    0.032 at most. Levels were not varied.
    """

    limb: float = 0.2
    """Share of the part's surface that lies on each limb, before half of the way between their ends, at least."""
    least_pairs: int = 2
    """Pairs of limbs of the body that are found, at least, as `MirroredJointsSettings.least_pairs`."""
    levels: tuple[float, ...] = (0.22, 0.29, 0.36, 0.43, 0.5, 0.57, 0.64, 0.71, 0.78, 0.85)
    """Distances from where the limbs go on, shares of the greatest on the part."""


class _HeldLimbs(NamedTuple):
    """A part that holds both limbs of a pair.

    hung   : the parts that hang on it where the limbs go on
    beside : its one other neighbour
    away   : (2, vertex) distance over the surface from the end of each limb, mesh unit
    """

    part: int
    hung: tuple[int, int]
    beside: int
    away: Floats


def limb_cuts(
    V: Floats,
    F: Ints,
    area: Floats,
    label: Ints,
    parents: Ints,
    rest: Floats,
    pairs: LimbPairs,
    settings: LimbCutsSettings | None = None,
) -> Iterator[EndCut]:
    """Rings across both limbs of every pair that one part holds, nearest to their ends first.

    V, F    : (vertex, xyz) reference, mesh unit · (face, corner)
    area    : (vertex,) mesh unit²
    label   : (vertex,) part
    parents : (part,) −1 for the root; a part comes after its parent
    rest    : (part, xyz) joints in the reference, mesh unit
    pairs   : limbs that are mirror images
    """
    chosen, edges = settings or LimbCutsSettings(), ring_edges(*rings(F, len(V)))
    for held in _held_limbs(area, label, parents, pairs, chosen):
        own = np.flatnonzero((label == held.part) & np.isfinite(held.away).all(axis=0))
        border = [np.intersect1d(own, edges[label[edges[:, 1]] == k, 0]) for k in held.hung]
        if min(map(len, border)):
            lowest = max(float(away[v].mean()) for away, v in zip(held.away, border, strict=True))
            highest = float(held.away[:, own].min(axis=0).max())
            joints = rest[[*held.hung, held.part if parents[held.part] >= 0 else held.beside]]
            for k, share in enumerate(chosen.levels):
                two = list(_at(V, area, edges, held, own, joints, lowest + share * (highest - lowest)))
                if len(two) == 2:
                    yield from (cut._replace(level=k) for cut in two)


def _held_limbs(area: Floats, label: Ints, parents: Ints, pairs: LimbPairs, chosen: LimbCutsSettings) -> Iterator[_HeldLimbs]:
    """The parts that hold both limbs of a pair and have one neighbour else, so that a chest with a head holds no arms."""
    below, known = beyond(parents) > 0, set[int]()
    if len(pairs.tip) < chosen.least_pairs:
        return
    for tips, away in zip(*pairs, strict=True):
        part = int(np.flatnonzero(below[:, label[tips]].all(axis=1))[-1])
        neighbours = {*np.flatnonzero(parents == part).tolist(), int(parents[part])} - {-1}
        limbs = [k for tip in tips for k in neighbours if k > part and below[k, label[tip]]]
        beside = neighbours - {*limbs}
        on_limb = away < (away[0][tips[1]] + away[1][tips[0]]) / 4.0
        own = area * ((label == part) & np.isfinite(away).all(axis=0))
        is_held = len(limbs) == 2 and len(beside) == 1 and min(on_limb @ own) >= chosen.limb * max(own.sum(), TINY)
        if is_held and part not in known:  # a limb with two ends has two pairs
            known.add(part)
            yield _HeldLimbs(part, (limbs[0], limbs[1]), beside.pop(), away)


def _at(V: Floats, area: Floats, edges: Ints, held: _HeldLimbs, own: Ints, joints: Floats, level: float) -> Iterator[EndCut]:
    """The rings at one distance from the ends of both limbs, each without what lies before the other one."""
    for side, other in ((0, 1), (1, 0)):
        mine, its = held.away[side], held.away[other]
        left = own[(its[own] >= level) | (mine[own] < its[own])]
        inside = edges[np.isin(edges, left).all(axis=1)]
        cut = ring_at(V, (held.part, held.hung[side]), left, mine, inside, level)
        if cut is not None and is_wide(cut, area, EndCutsSettings()):
            apart = float(np.linalg.norm(joints - cut.centre, axis=1).min()) / max(cut.radius, TINY)
            yield cut._replace(hung=(held.hung[other], held.beside), apart=apart)
