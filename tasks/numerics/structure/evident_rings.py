"""Which rings are joints, by what they show in the frames (ours, see `end_joints`)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.structure.end_cuts import EndCut
from kinetree.tasks.numerics.structure.end_rings import EndRing
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.ring_evidence import RingEvidence

Scores = dict[int, float]
"""By ring that is a joint, its score."""


class EvidentRingsSettings(NamedTuple):
    """What a ring must show to be a joint.

    Turns were chosen on wave, dance, ballet, wolf, people 0, 1, 5, 6, 7, four-legged 5, 6 and random trees 1, 6.
    """

    least_score: float = 0.006
    """Score of a ring (`ring_evidence`), at least. Chosen on wave, dance, ballet, wolf, people 0 to 19 and 60 to 69 and humans,
    four-legged and random trees 60 to 63: of 26 true joints the least had 0.0061 with straight hinges, rings where nothing
    turns 0.0032 at most. With bent ones two rings in hands of person 92 have 0.0050 and 0.0058, a true wrist 0.0055."""
    least_score_if_short: float = 0.0145
    """The same where the nearer piece is shorter than `slice_length`, as a neck is. On these bodies five true heads have 0.0164
    to 0.0263, two that shape gives as well 0.0117 and 0.0127; rings within heads, of people 86 to 99 too, and beside a foot of
    four-legged 0 have 0.0130 at most."""
    least_score_in_trunk: float = 0.05
    """The same across the trunk. Of 0.04, 0.05 and 0.06 chosen on 132 bodies (RESULTS, "The limit of rings across the trunk"):
    against 0.06 four more joints are found with 0.05 and none is false, with 0.04 three more yet, and five are false."""
    least_score_if_divided: float = 0.066
    """The same across a trunk with two joints and more between pairs of limbs. There true ones of 115 people, generated and
    recorded bodies have 0.071 and more, three false ones 0.056 to 0.062; where the trunk has fewer, seven true ones have 0.051
    to 0.062."""
    least_score_across_limbs: float = 0.05
    """The same across both limbs of a pair, of the clearer one. Not varied: chosen with `least_score_in_trunk`."""
    least_apart: float = 0.6
    """Distance of a ring across the trunk from the nearest of the part's joints, in radii of the ring, at least: the likeliest
    ring of a part that lies nearer says that the joint that is there is a little off."""
    least_apart_if_closer: float = 0.75
    """The same of rings that lie closer together, see `extended_tree`. Joints that these alone show lie at 1.07 to 1.58. Where
    nothing turns, within the chests of four-legged 4 and 60, rings at 0.67 and 0.66 score 0.0595 and 0.0566, those farther
    away 0.0465 at most. Chosen on the same bodies and on people 86 to 129, humans, four-legged and random trees 65 to 74."""
    nearer: float = 4.0
    """Root mean square turn of the nearer piece against the part above, degrees, as `degrees`, at least: where it turns less it
    belongs to the part above, and the joint that is there lies at a wrong place. There it was 3.4° at most, at true joints
    6.1° or more."""
    degrees: float = 2.0
    """Root mean square turn of the hinge that agrees from frame to frame, or by halves, at least: that of a swing over 6°,
    which other joints need."""
    slice_length: float = 2.1
    """Length of the nearer piece, from joint to ring, in radii of the ring, from which on it may turn less than the piece
    beyond turns against it. A shorter one that does is a slice of a joint that is there already, a little off. Chosen on people
    5, 7, 14 to 18 and 20 in three takes: four such had 1.0 to 1.9, true joints with that turning 2.4 or more."""
    slice_length_if_mirrored: float = 2.3
    """Length of the nearer piece, in radii, below which it is a slice in a limb with a mirror image, however much it turns:
    necks alone are as short. On the same people true joints had 2.6 to 5.2, two false ones 1.5 and 1.7; across feet of people
    545 to 569, 1, 8 and 12 the shortest has 2.37, and two rings across hands, of person 561 and of every fourth frame of the
    dance, have 2.14 and 2.20."""


def evident_rings(
    tree: FirstTree,
    rings: Sequence[EndRing],
    shown: Sequence[Sequence[RingEvidence]],
    settings: EvidentRingsSettings | None = None,
) -> Scores:
    """The rings that are joints: one of a part at most, of one that holds both limbs of a pair one across each limb.

    shown    : by take, what every ring shows; a part's rings are judged in the take in which one of them shows most
    """
    chosen = settings or EvidentRingsSettings()
    limbs = _across_limbs(rings, shown, chosen)
    single = _apart_from(tree, rings, _across_parts(rings, shown, chosen), limbs)
    return {**_one_beside_each_joint(tree, rings, single), **limbs}


def needed_score(ring: EndRing, settings: EvidentRingsSettings) -> float:
    """The score that a ring needs."""
    if ring.cut.hung:
        return settings.least_score_in_trunk
    if _is_short(ring, settings.slice_length):
        return settings.least_score_if_short
    return settings.least_score


def joint_inwards(tree: FirstTree, cut: EndCut) -> int:
    """The joint with the one other neighbour of a part that holds both limbs of a pair, by the part that turns about it."""
    return cut.part if tree.parents[cut.part] >= 0 else cut.hung[-1]


def _across_parts(
    rings: Sequence[EndRing],
    shown: Sequence[Sequence[RingEvidence]],
    chosen: EvidentRingsSettings,
) -> Scores:
    """Of each part's rings the likeliest one, if it shows and turns enough; rings across limbs of a pair left out.

    At an end, as in a head, it is the likeliest of all: where a ring shows most that is too close to the joint before it, those
    beyond show a part of the same. Across the trunk, and in limbs with a mirror image, where rings so close are none whatever
    they show, it is the likeliest of those with enough score.
    """
    evident: Scores = {}
    for part in sorted({ring.cut.part for ring in rings}):
        own = [k for k, ring in enumerate(rings) if ring.cut.part == part and not ring.cut.is_across_limb]
        if own:
            least = {k: needed_score(rings[k], chosen) for k in own}
            best = max(shown, key=lambda row: max(row[k].score / least[k] for k in own))
            of_all = not rings[own[0]].cut.hung and not rings[own[0]].is_mirrored
            asked = [k for k in own if of_all or best[k].score >= least[k]] or own
            k = max(asked, key=lambda k: (_rank(rings[k], best[k]), k))
            if best[k].score >= least[k] and _is_joint(rings[k], best[k], chosen):
                evident[k] = best[k].score
    return evident


def _across_limbs(rings: Sequence[EndRing], shown: Sequence[Sequence[RingEvidence]], chosen: EvidentRingsSettings) -> Scores:
    """Of each part that holds both limbs of a pair the two rings that show most together, the clearer one last.

    The clearer one must show enough; both must turn enough, for the limbs moved alike.
    """
    twins: dict[int, dict[int, list[int]]] = {}
    for k, ring in enumerate(rings):
        if ring.cut.is_across_limb:
            twins.setdefault(ring.cut.part, {}).setdefault(ring.cut.level, []).append(k)
    evident: Scores = {}
    for levels in twins.values():
        row, two = max(
            ((row, two) for row in shown for two in levels.values()), key=lambda one: sum(one[0][k].score for k in one[1])
        )
        two = sorted(two, key=lambda k: row[k].score)
        turn = all(_is_joint(rings[k], row[k], chosen) for k in two)
        if turn and row[two[-1]].score >= chosen.least_score_across_limbs:
            evident |= {k: row[k].score for k in two}
    return evident


def _apart_from(tree: FirstTree, rings: Sequence[EndRing], evident: Scores, limbs: Scores) -> Scores:
    """The same without rings across parts whose limbs are cut off, and across others beside the joints of these parts.

    Without its limbs such a part moves otherwise, so that its joint is elsewhere: it is asked again then.
    """
    parts = {rings[k].cut.part for k in limbs}
    joints = {joint_inwards(tree, rings[k].cut) for k in limbs}
    return {
        k: score
        for k, score in evident.items()
        if not (cut := rings[k].cut).hung or (cut.part not in parts and _nearest_joint(tree, cut) not in joints)
    }


def _one_beside_each_joint(tree: FirstTree, rings: Sequence[EndRing], evident: Scores) -> Scores:
    """The same with the best one of those rings across the trunk that have the same joint nearest to them.

    Where a joint that is there lies amid two true ones, both rings show one; once one of them is a joint, the other goes to its
    place.
    """
    best: dict[int, int] = {}
    for k, score in evident.items():
        if rings[k].cut.hung:
            nearest = _nearest_joint(tree, rings[k].cut)
            if score > (evident[best[nearest]] if nearest in best else -np.inf):
                best[nearest] = k
    return {k: score for k, score in evident.items() if not rings[k].cut.hung or k in best.values()}


def _nearest_joint(tree: FirstTree, cut: EndCut) -> int:
    """The joint of a ring's part that lies nearest to the ring, by the part that turns about it."""
    own = [k for k in (cut.part, *np.flatnonzero(tree.parents == cut.part).tolist()) if tree.parents[k] >= 0]
    return min(own, key=lambda k: float(np.linalg.norm(tree.rest[k] - cut.centre)))


def _rank(ring: EndRing, shown: RingEvidence) -> float:
    """How likely a ring is among those of its part: the less it leaves, since scores stay alike along a limb.

    Across the trunk, where rings come from several sides, by the score.
    """
    return shown.score if ring.cut.hung else shown.gain


def _is_short(ring: EndRing, radii: float) -> bool:
    """Whether the piece before the ring is shorter than that."""
    return bool(np.linalg.norm(ring.cut.centre - ring.piece.joint) < radii * ring.cut.radius)


def _is_joint(ring: EndRing, shown: RingEvidence, chosen: EvidentRingsSettings) -> bool:
    """Whether both pieces turn enough, and the nearer one is no slice of a joint that is there already."""
    short = chosen.slice_length_if_mirrored if ring.is_mirrored else chosen.slice_length
    is_clear = ring.cut.apart >= chosen.least_apart if ring.cut.hung else not _is_short(ring, short)
    is_slice = not is_clear and (bool(ring.cut.hung) or ring.is_mirrored or shown.near < shown.far)
    return shown.far >= chosen.degrees and shown.near >= chosen.nearer and not is_slice
