"""Rings across the ends of limbs that narrow: one where the hand begins, and none within its palm (ours).

A wrist that turns a little, and flesh of a hand that stays behind when the arm swings, bend the last part of a limb alike.
Rings lie at a few distances from its border (`end_cuts`), so that one amid the palm may come nearer to both than those beside
the wrist do. The shape shows where the wrist is (`narrowings`): a ring lies there, too, and none a little farther out.
"""

from collections.abc import Iterable

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.end_cuts import EndCut, EndCutsSettings, is_wide, ring_at
from kinetree.tasks.numerics.structure.end_effectors import from_border
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.narrowings import Narrowing, limb_narrowings

PALM = (1.0, 3.2)
"""From where to where beyond the beginning of a hand no ring lies, radii of the narrowing. Persons 868 and 892, who run, had
joints there, 2.5 and 1.3 beyond; 33 wrists that cuts have lie 1.0 before to 0.6 beyond, balls of feet 4 beyond ankles. With 1.2
and 3.2 a rigged body that walks loses a hand."""
SAME = 0.5
"""Distance of another ring from where the hand begins, radii, below which no ring is added there."""


def with_hand_rings(
    V: Floats, F: Ints, area: Floats, tree: FirstTree, cuts: Iterable[EndCut], pairs: LimbPairs
) -> list[EndCut]:
    """The rings across the last parts of limbs, part by part, nearest to the border first.

    V, F, area : (vertex, xyz) reference, mesh unit · (face, corner) · (vertex,) mesh unit²
    cuts       : rings across the last parts of limbs, see `end_cuts`
    pairs      : limbs that are mirror images; no others are looked at
    """
    found, parts = list(cuts), RootedParts(tree.label, tree.parents, tree.radius)
    for narrowing in (one for both in limb_narrowings(V, F, parts, tree.rest, pairs) for one in both if one is not None):
        beyond = [_radii_beyond(narrowing, cut) if cut.part == narrowing.part else np.inf for cut in found]
        low, high = PALM
        found = [cut for cut, radii in zip(found, beyond, strict=True) if not low <= radii <= high]
        if not any(abs(radii) < SAME for radii in beyond):
            found += _ring_at_wrist(V, F, area, tree, narrowing)
    return sorted(found, key=lambda cut: (cut.part, -float(cut.beyond.max())))


def _radii_beyond(narrowing: Narrowing, cut: EndCut) -> float:
    """How far a ring lies beyond where the hand begins, radii of the narrowing; not finite where no path leads."""
    at_ring = narrowing.away[cut.own][np.abs(cut.beyond) < cut.radius / 2.0]
    return float((narrowing.place - np.median(at_ring)) / narrowing.radius) if len(at_ring) else np.inf


def _ring_at_wrist(V: Floats, F: Ints, area: Floats, tree: FirstTree, narrowing: Narrowing) -> list[EndCut]:
    """The ring where a hand begins, if it can be judged."""
    part, label = narrowing.part, tree.label
    own, edge = np.flatnonzero(label == part), ring_edges(*rings(F, len(V)))
    distance, inside = from_border(V, edge, label, part), edge[(label[edge] == part).all(axis=1)]
    there = own[np.abs(narrowing.away[own] - narrowing.place) < narrowing.radius / 2.0]
    if not len(there):
        return []
    cut = ring_at(V, (part, int(tree.parents[part])), own, distance, inside, float(np.median(distance[there])))
    return [cut] if cut is not None and is_wide(cut, area, EndCutsSettings()) else []
