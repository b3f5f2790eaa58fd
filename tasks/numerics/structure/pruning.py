"""Which parts are parts: joints turn by themselves and more than they drift; the rest is flesh, cloth or error (ours).

A part that fails is dropped and its vertices go to the parts around it, never merged as a rigid whole: merging across a bad
border once made two parts of a body. The tree is then built anew. A part stays if without it the worst joint would be worse.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.end_effectors import from_border
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence, least_evident_joint
from kinetree.tasks.numerics.structure.joint_partners import RootedParts, in_mirrored_limbs, joint_partners
from kinetree.tasks.numerics.structure.joint_rotations import in_between
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree, part_tree, relative_rotation
from kinetree.tasks.numerics.structure.unpaired_parts import UnpairedPartsSettings, unpaired_joints, unpaired_parts
from kinetree.tasks.numerics.structure.vertex_reassignment import reassigned

FLESH, STILL, SLIDING, UNEVIDENT, UNPAIRED, ALONE, MIDWAY, SMEARED = (
    "flesh", "still", "sliding", "unevident", "unpaired", "alone", "midway", "smeared"
)  # fmt: skip
"""Why a part is dropped: a ring of flesh around a joint or beyond a bend of flesh (`inertial_joints`), turns too little, drifts
too much, not shown by the frames, a ring of flesh that the mirror image of its limb lacks, or that no other cut has, and
(`shown_joints`) because its joint lay midway between two that the frames show, or, at the end of a limb, close to the joint
before, where they show another without it."""

NO_PART = -1
"""`Pruned.origin` of a part that the cut does not have: a hidden bone, or a limb that was cut off another or off the trunk."""


class PruningSettings(NamedTuple):
    """What a joint must show to stay."""

    degrees: float
    """Range by which a joint turns, at least. Chosen on thirty generated bodies: with 8° three more true joints are lost."""
    ratio: float
    """Displacement that turning gives the smaller side of a joint, in drifts of the joint, at least. Not recorded."""
    leaf: float = 0.625
    """What the last part of a limb that has a leaf needs of it, share: hands and feet are small. Not recorded. Halved or
    doubled it moves no joint of two generated bodies."""
    flap: float = 3.75
    """What a last part without a leaf needs of it, multiple: few bodies have a limb there. Not recorded. Halved or doubled
    it moves no joint of two generated bodies."""
    flat: float = 1.0
    """How far the surface of a last part without a leaf reaches beyond its border, in radii of the border; below it the part is
    flesh beside a joint: a flat disc reaches so far. False parts had 0.23 to 0.26 and 0.61 (quadrupeds 0, 1, 3, people 716 and
    770), all other last parts of 35 bodies 1.24 and more, of 60 people and generated bodies 1.6 and more."""
    clear_ratio: float = 3.0
    """Ratio from which on a joint is clear: a part that has a clear joint stays when another of its joints is poor. Not
    recorded. Halved or doubled it moves no joint of two generated bodies; it guards parts between a good joint and a poor
    one."""
    flesh_share: float = 0.92
    """Share of a part's turning that follows from that of the part beyond it, above which it is flesh. Not recorded. Halved
    it moves no joint of two generated bodies."""
    flesh_length: float = 1.25
    """Length of such a part at most, from joint to joint, in radii of its borders. Not recorded. Halved or doubled it moves
    no joint of two generated bodies."""
    trunk_length: float = 1.0
    """The same outside the limbs of a body that has limbs with mirror images: vertebrae are short, and turn by a share of what
    lies beyond. Chosen on people 26 to 45: with 0.8 and with 1.0 two more joints of 823 are found; with 0 three of 1,091,
    and a spurious one."""
    slab_length: float = 1.0
    """Of several takes, length in radii of its borders from which downwards a part is flesh more readily: the share that it
    needs falls by what its length lacks. Chosen on people 0 to 3 in three takes, of whose 14 false parts 13 were 0.3 to 0.85
    radii long. Of single takes not used: a true part of a dance has 0.84."""
    worse: float = 0.9
    """A part is dropped only if the worst ratio without it is at least this share of the worst ratio with it. Not recorded.
    Halved or doubled it moves no joint of two generated bodies; it guards parts without which the tree would be worse."""
    unpaired: UnpairedPartsSettings = UnpairedPartsSettings()
    """What makes a part flesh that the mirror image of its limb lacks."""


class Dropped(NamedTuple):
    """A part that is none, by its number before any was dropped, and why: one of the reasons above."""

    part: int
    reason: str


class Pruned(NamedTuple):
    """The parts that are left, the tree they are in, and how they came about.

    parts     : numbered without gaps
    part_tree : of these parts
    before    : the tree of all parts, before any was dropped
    origin    : (part,) number of each part left, before any was dropped; `NO_PART` for one that the cut does not have
    dropped   : in the order in which parts were dropped
    """

    parts: MovingParts
    part_tree: PartTree
    before: PartTree
    origin: Ints
    dropped: tuple[Dropped, ...]


def pruned(
    body: MovingSurface,
    parts: MovingParts,
    leaves: Ints,
    evidence: FrameEvidence | None = None,
    *,
    settings: PruningSettings,
    pairs: LimbPairs | None = None,
) -> Pruned:
    """Drops parts, the weakest first, until none is weak or none can be spared; then those that no frame shows, and those that
    the mirror image of their limb lacks.

    leaves   : (leaf,) vertices at the ends of limbs
    evidence : the frames' surfaces; None where every vertex was followed
    pairs    : limbs that are mirror images; None has them found
    """
    chosen = _by_takes(body, settings)
    start, ring = rings(body.F, len(body.V))
    tree = part_tree(body, parts)
    pairs = limb_pairs(body.V, body.F, leaves) if pairs is None else pairs
    state = _pruned_by_motion(body, Pruned(parts, tree, tree, np.arange(parts.R.shape[1]), ()), leaves, pairs, chosen)
    while evidence is not None:
        partner = joint_partners(body.F, RootedParts.of(state.parts.label, state.part_tree), pairs, chosen.unpaired.paired)
        gone = least_evident_joint(body, state.parts, state.part_tree, evidence, partner)
        if gone < 0:
            break
        left = _without(body, state, gone, UNEVIDENT, start, ring)
        state = _pruned_by_motion(body, left, leaves, pairs, chosen)
    return _pruned_by_partners(body, state, leaves, pairs, chosen)


def without_flesh(body: MovingSurface, state: Pruned, gone: int) -> Pruned:
    """The same without a part that turned out to be flesh, whose vertices go to the parts around it."""
    return _without(body, state, gone, FLESH, *rings(body.F, len(body.V)))


def shared_out(body: MovingSurface, state: Pruned, gone: int, to: Ints, reason: str) -> Pruned:
    """The same without a part, by its number among those that are left; to (vertex,) the part that its vertices go to."""
    fewer = state.parts.without(gone, np.where(state.parts.label == gone, to, state.parts.label))
    dropped = (*state.dropped, Dropped(int(state.origin[gone]), reason))
    return Pruned(fewer, part_tree(body, fewer), state.before, np.delete(state.origin, gone), dropped)


def pruned_without(
    body: MovingSurface, state: Pruned, gone: int, reason: str, leaves: Ints, pairs: LimbPairs, settings: PruningSettings
) -> Pruned:
    """The same without one part, by its number among those that are left, and without those that are weak then.

    leaves, pairs : (leaf,) vertices at the ends of limbs · those that are mirror images
    """
    left = _without(body, state, gone, reason, *rings(body.F, len(body.V)))
    return _pruned_by_motion(body, left, leaves, pairs, _by_takes(body, settings))


def without_flat_ends(body: MovingSurface, state: Pruned, leaves: Ints, flat: float) -> Pruned:
    """The same without last parts that have no leaf and hardly reach beyond their border, which go to the part above.

    leaves : (leaf,) vertices at the ends of limbs
    flat   : see `PruningSettings`
    """
    tree, label = state.part_tree.tree, state.parts.label
    reach = _flat_parts(body, label, state.part_tree, np.isin(np.arange(len(tree.order)), label[leaves]))
    flattest = min(reach, key=lambda part: reach[part], default=-1)
    if flattest < 0 or reach[flattest] >= flat:
        return state
    above = int(tree.order[tree.parents[np.flatnonzero(tree.order == flattest)[0]]])
    return without_flat_ends(body, shared_out(body, state, flattest, np.full(len(label), above), FLESH), leaves, flat)


def _by_takes(body: MovingSurface, settings: PruningSettings) -> PruningSettings:
    """Slabs count where there are several takes."""
    return settings if len(body.takes or ()) > 1 else settings._replace(slab_length=0.0)


def _pruned_by_motion(body: MovingSurface, state: Pruned, leaves: Ints, pairs: LimbPairs, chosen: PruningSettings) -> Pruned:
    """Drops weak parts until none is weak or none can be spared."""
    start, ring = rings(body.F, len(body.V))
    while True:
        for part, reason in _weak_parts(body, state.parts, state.part_tree, leaves, pairs, chosen).items():
            fewer = _without(body, state, part, reason, start, ring)
            if fewer.part_tree.ratio.min() >= chosen.worse * state.part_tree.ratio.min():
                state = fewer
                break
        else:
            return state


def _pruned_by_partners(body: MovingSurface, state: Pruned, leaves: Ints, pairs: LimbPairs, chosen: PruningSettings) -> Pruned:
    """Drops parts that the mirror image of their limb lacks, as long as fewer joints are without a partner then."""
    start, ring = rings(body.F, len(body.V))
    lonely = unpaired_joints(body.F, RootedParts.of(state.parts.label, state.part_tree), pairs, chosen.unpaired)
    while True:
        for gone in unpaired_parts(body.F, state.parts, state.part_tree, pairs, chosen.unpaired):
            left = _pruned_by_motion(body, _without(body, state, gone, UNPAIRED, start, ring), leaves, pairs, chosen)
            fewer = unpaired_joints(body.F, RootedParts.of(left.parts.label, left.part_tree), pairs, chosen.unpaired)
            if fewer < lonely:
                state, lonely = left, fewer
                break
        else:
            return state


def _without(body: MovingSurface, state: Pruned, gone: int, reason: str, start: Ints, ring: Ints) -> Pruned:
    """The same without one part, whose vertices go to the parts around it."""
    parts = state.parts
    return shared_out(body, state, gone, reassigned(body.V, body.x, parts.label, gone, parts.R, parts.t, start, ring), reason)


def _weak_parts(
    body: MovingSurface, parts: MovingParts, found: PartTree, leaves: Ints, pairs: LimbPairs, chosen: PruningSettings
) -> dict[int, str]:
    """Parts that may be none, the weakest first, and why: flesh, else what turns too little, else what drifts too much."""
    tree, mass = found.tree, np.bincount(parts.label, body.area, parts.R.shape[1])
    has_leaf = np.isin(np.arange(len(mass)), parts.label[leaves])
    in_limb = in_mirrored_limbs(RootedParts.of(parts.label, found), pairs)
    reach = np.where(in_limb | ~in_limb.any(), chosen.flesh_length, chosen.trunk_length)
    scores = [(_flesh_score(parts.R, found, k, reach[k], chosen), int(part), FLESH) for k, part in enumerate(tree.order)]
    for k in range(1, len(mass)):
        part, above = int(tree.order[k]), int(tree.order[tree.parents[k]])
        if {part, above} in parts.by_shape:
            continue
        smaller = min((part, above), key=lambda p: (mass[p], p))
        last = not (tree.parents == k).any()
        scores.append((found.degrees[k] / max(chosen.degrees, 1e-9), smaller, STILL))
        if last and not has_leaf[part]:
            least = chosen.flap * chosen.ratio
            scores.append((found.ratio[k] / max(least, 1e-9), part, SLIDING))
            continue
        least = chosen.leaf * chosen.ratio if last else chosen.ratio
        spare = [p for p in (smaller, part + above - smaller) if not _has_clear_joint(found, p, k, chosen.clear_ratio)]
        scores += [(found.ratio[k] / max(least, 1e-9), p, SLIDING) for p in spare[:1]]
    flats = _flat_parts(body, parts.label, found, has_leaf)
    scores += [(flats[part] / chosen.flat, part, FLESH) for part in flats]
    failed = [entry for entry in scores if entry[0] < 1.0]
    reasons = {part: reason for kind in (SLIDING, STILL, FLESH) for _, part, reason in failed if reason == kind}
    return {part: reasons[part] for _, part, _ in sorted(failed)}


def _flat_parts(body: MovingSurface, label: Ints, found: PartTree, has_leaf: Flags) -> dict[int, float]:
    """How far the surface of every last part without a leaf reaches beyond its border, in radii of the border."""
    order, parents = found.tree.order, found.tree.parents
    bare = [k for k in range(1, len(order)) if not has_leaf[order[k]] and not (parents == k).any()]
    if not bare:
        return {}
    start, ring = rings(body.F, len(body.V))
    edge = ring_edges(start, ring)
    radius = np.maximum(found.borders.radius[found.tree.border], np.finfo(float).tiny)
    return {int(order[k]): float(from_border(body.V, edge, label, int(order[k])).max() / radius[k]) for k in bare}


def _has_clear_joint(found: PartTree, part: int, k: int, clear_ratio: float) -> bool:
    """Whether a part has a clear joint other than the k-th."""
    tree = found.tree
    place = int(np.flatnonzero(tree.order == part)[0])
    others = (tree.parents == place) | (np.arange(len(tree.order)) == place)
    others[[0, k]] = False
    return bool((found.ratio[others] >= clear_ratio).any())


def _flesh_score(R: Floats, found: PartTree, k: int, longest: float, chosen: PruningSettings) -> float:
    """Below 1, and the lower the clearer, where the part at the k-th place is a ring of flesh between two neighbours.

    longest : length of one at most, radii of its borders
    """
    tree = found.tree
    children = np.flatnonzero(tree.parents == k)
    if k == 0 and len(children) != 2:
        return np.inf
    pairs = [(int(children[0]), int(children[1]))] if k == 0 else [(k, int(c)) for c in children]
    return min((_ring_score(R, found, k, *pair, longest, chosen) for pair in pairs), default=np.inf)


def _ring_score(R: Floats, found: PartTree, k: int, one: int, other: int, longest: float, chosen: PruningSettings) -> float:
    """The same for two of its joints: how near they are, if the part turns by a share of what both turn by."""
    tree = found.tree
    rows = tree.border[[one, other]]
    distance = float(np.linalg.norm(np.diff(found.joints.rest[rows], axis=0)))
    radius = float(found.borders.radius[rows].min())
    reach = longest * radius
    lacking = max(chosen.slab_length * radius - distance, 0.0) / max(radius, np.finfo(float).tiny)
    top = int(tree.order[one if k == 0 else tree.parents[k]])
    ring, end = int(tree.order[k]), int(tree.order[other])
    follows = in_between(relative_rotation(R, top, ring), relative_rotation(R, top, end))
    if distance > reach or follows < chosen.flesh_share - lacking:
        return np.inf
    return distance / reach - 1.0
