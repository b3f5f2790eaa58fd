"""The tree that the cuts agree on, without joints that no other cut has and that it does not need (ours).

In another pose rings and patches fall elsewhere, so that a joint which one cut alone has is likely of its own making: a ring of
flesh beside a true joint, which takes its share of the turn. Not every one is: a bone that is hardly seen is found in one cut
of four. Without a true joint its neighbours drift more; without a ring of flesh one joint does as well as two.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.agreeing_cut import agreeing_cut, in_other_cuts
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.joint_partners import RootedParts, in_mirrored_limbs, symmetry
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.mirrored_slices import MirroredSlicesSettings, Slice, mirrored_slices
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartPairs, part_tree
from kinetree.tasks.numerics.structure.pruning import (
    ALONE,
    FLESH,
    Dropped,
    Pruned,
    pruned_without,
    shared_out,
    without_flat_ends,
)
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings, TreeJoints, tree_joints, tree_of_parts
from kinetree.tasks.numerics.structure.trunk_flesh import with_trunk_flesh
from kinetree.tasks.numerics.structure.trunk_slices import trunk_slices

RISE = 1.15
"""Without a part some joints go and others come in their place. The largest drift of those that come, in the largest of those
that go, at most. Of people, and of recorded bodies at a quarter of the frames, false joints had 0.71 to 1.10, true ones 1.27
and more."""


class AgreedTree(NamedTuple):
    """The tree that the cuts agree on.

    which : whose it is, see `agreeing_cut`
    tree  : without joints at ends
    """

    which: int
    tree: FirstTree


class _Without(NamedTuple):
    """The tree without a part.

    joints : of the parts that are left
    rise   : see `RISE`
    """

    joints: TreeJoints
    rise: float


def agreed_tree(
    body: MovingSurface,
    trees: Sequence[FirstTree],
    leaves: Ints,
    confidence: Floats | None,
    evidence: FrameEvidence | None = None,
    *,
    settings: KinematicTreeSettings,
) -> AgreedTree:
    """Chooses the cut whose tree is used, and drops its parts with a joint that no other of at least two cuts has.

    The part without which joints drift least goes first, with those that are weak then. They go if so many joints fewer are
    this cut's alone then, so that as many as before are those of other cuts, if none drifts more (`RISE`), and if no two limbs
    that are mirror images become one part. Where vertices were aligned, slices across the trunk go too (`trunk_slices`), and
    of limbs of a pair (`mirrored_slices`), and flesh of the trunk that they hold goes back to it (`trunk_flesh`).

    trees      : of all cuts, in the reference, the first cut's first; without joints at ends and bones that no cut can find
    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    evidence   : the frames' surfaces, which must show every joint of another cut's tree, as they show those of the first;
                 None asks for no evidence
    """
    pairs = limb_pairs(body.V, body.F, leaves)
    which, tree = _best(body, trees, pairs, settings), trees[0]
    if which:
        best = trees[which]
        cut = Cut(body.V, best.label, best.R, best.t, best.unexplained)
        shown = _of_cut(best, tree_joints(body, cut, leaves, confidence, evidence, settings=settings))
        still = _best(body, [*trees[:which], shown, *trees[which + 1 :]], pairs, settings) == which
        which, tree = (which, shown) if still else (0, tree)
    others = [other.motion.carried(other.rest[1:]) for k, other in enumerate(trees) if k != which]
    tree = _without_lone_joints(body, tree, leaves, pairs, confidence, others, settings)
    if confidence is not None:
        while across := trunk_slices(body, tree, leaves, pairs):
            tree = _without_slices(body, tree, across, confidence, settings)
        slices = mirrored_slices(body, tree, pairs, confidence, settings.pruning.unpaired.paired)
        tree = _without_slices(body, tree, slices, confidence, settings, MirroredSlicesSettings().most_drift)
        tree = _without_flesh(body, tree, leaves, pairs, confidence, settings)
    return AgreedTree(which, tree)


def _best(body: MovingSurface, trees: Sequence[FirstTree], pairs: LimbPairs, settings: KinematicTreeSettings) -> int:
    """The cut whose tree is used by these trees."""
    paired = settings.pruning.unpaired.paired
    limbs = [symmetry(body.F, RootedParts(tree.label, tree.parents, tree.radius), pairs, paired) for tree in trees]
    return agreeing_cut(trees, body.size, limbs)


def _without_lone_joints(
    body: MovingSurface,
    tree: FirstTree,
    leaves: Ints,
    pairs: LimbPairs,
    confidence: Floats | None,
    others: Sequence[Floats],
    settings: KinematicTreeSettings,
) -> FirstTree:
    """The tree without joints that no other cut has and that it does not need; of two cuts neither is in the majority."""
    if len(others) < 2 or in_other_cuts(tree.motion.carried(tree.rest[1:]), others, body.size).all():
        return tree
    joints = _joints(body, tree, _pruned(body, tree), confidence, settings)
    while (left := _without_one(body, joints, leaves, pairs, confidence, others, settings)) is not None:
        joints = left
    return _of_cut(tree, joints) if joints.left.dropped else tree


def _without_slices(
    body: MovingSurface,
    tree: FirstTree,
    slices: Sequence[Slice],
    confidence: Floats,
    settings: KinematicTreeSettings,
    most_drift: float = np.inf,
) -> FirstTree:
    """The tree without slices of flesh, shared out between their neighbours so that few joints drift.

    most_drift : radii; a slice without which its joint drifts more stays
    """
    chosen = MirroredSlicesSettings()
    while slices:
        start, count = _pruned(body, tree), len(slices)
        tried = [_joints_without(body, tree, start, slices, [share] * count, confidence, settings) for share in chosen.shares]
        drift = np.array([_widest(_between(joints, joints.drift), slices) for joints in tried])
        first = (drift <= chosen.looser * drift.min(axis=0)).argmax(axis=0)
        shares, is_one = [chosen.shares[k] for k in first], (first == first[0]).all()
        left = tried[first[0]] if is_one else _joints_without(body, tree, start, slices, shares, confidence, settings)
        in_radii = _widest(_between(left, left.drift / np.maximum(left.radius, np.finfo(float).tiny)), slices)
        if (in_radii <= most_drift).all():
            return _of_cut(tree, left)
        slices = [one for one, widest in zip(slices, in_radii, strict=True) if widest <= most_drift]
    return tree


def _widest(between: dict[frozenset[int], float], slices: Sequence[Slice]) -> Floats:
    """(slice,) the largest value of the joints in a slice's place, by the parts that meet in them; infinite without one."""
    return np.array([max(between.get(frozenset((one.above, k)), np.inf) for k in one.below) for one in slices])


def _without_flesh(
    body: MovingSurface,
    tree: FirstTree,
    leaves: Ints,
    pairs: LimbPairs,
    confidence: Floats,
    settings: KinematicTreeSettings,
) -> FirstTree:
    """The tree with flesh of the trunk that limbs of a pair hold as part of the trunk, and without parts that are left flat."""
    left = _pruned(body, tree)
    new = with_trunk_flesh(body, left, pairs, confidence, settings.pruning.unpaired.paired)
    new = without_flat_ends(body, new, leaves, settings.pruning.flat)
    return tree if new is left else _of_cut(tree, _joints(body, tree, new, confidence, settings))


def _joints_without(
    body: MovingSurface,
    tree: FirstTree,
    left: Pruned,
    slices: Sequence[Slice],
    shares: Sequence[float],
    confidence: Floats,
    settings: KinematicTreeSettings,
) -> TreeJoints:
    """The joints of the tree without slices.

    left   : the parts of the tree
    shares : (slice,) see `MirroredSlicesSettings`
    """
    for one, share in zip(slices, shares, strict=True):
        gone, above, *below = (int(np.flatnonzero(left.origin == k)[0]) for k in (one.part, one.above, *one.below))
        left = left._replace(parts=_neighbours_joined(left.parts, gone, frozenset(frozenset((above, k)) for k in below)))
        left = shared_out(body, left, gone, np.where(one.inwards < share, below[0], above), FLESH)
    return _joints(body, tree, left, confidence, settings)


def _neighbours_joined(parts: MovingParts, gone: int, new: PartPairs) -> MovingParts:
    """The same parts; where joints of one that goes are to stay, so are those of its neighbours in its place."""
    joined, by_shape = (pairs | new if any(gone in one for one in pairs) else pairs for pairs in (parts.joined, parts.by_shape))
    return parts._replace(joined=joined, by_shape=by_shape)


def _pruned(body: MovingSurface, tree: FirstTree) -> Pruned:
    """The parts of a tree, of which none is dropped yet."""
    parts = MovingParts(tree.label, tree.R, tree.t, tree.unexplained, tree.certain_share, *_kept_joints(tree))
    found = part_tree(body, parts)
    return Pruned(parts, found, found, np.arange(len(tree.parents)), ())


def _joints(
    body: MovingSurface, tree: FirstTree, left: Pruned, confidence: Floats | None, settings: KinematicTreeSettings
) -> TreeJoints:
    """The joints of the parts of a tree that are left."""
    return tree_of_parts(body, left, np.arange(len(tree.parents)), tree.label, confidence, settings)


def _kept_joints(tree: FirstTree) -> tuple[PartPairs, PartPairs]:
    """`MovingParts.joined` and `MovingParts.by_shape` of a tree with limbs that were cut off: all its joints, and theirs."""
    joints = [(part, above) for part, above in enumerate(tree.parents.tolist()) if above >= 0]
    is_cut_off = ~np.isin(np.arange(len(tree.parents)), tree.place)
    by_shape = frozenset(frozenset(pair) for pair in joints if is_cut_off[[*pair]].any())
    return (frozenset(map(frozenset, joints)), by_shape) if by_shape else (frozenset(), frozenset())


def _without_one(
    body: MovingSurface,
    joints: TreeJoints,
    leaves: Ints,
    pairs: LimbPairs,
    confidence: Floats | None,
    others: Sequence[Floats],
    settings: KinematicTreeSettings,
) -> TreeJoints | None:
    """The tree without the part that is needed least, and without those that go with it; None where all are needed."""
    tree = joints.left.part_tree.tree
    shared = _shared_joints(joints, others, body.size)
    sides = {side for joint in np.flatnonzero(~shared) + 1 for side in (int(joint), int(tree.parents[joint]))}
    best: _Without | None = None
    for side in sorted(side for side in sides if (tree.parents == side).sum() + (side > 0) > 1):
        left = pruned_without(body, joints.left, int(tree.order[side]), ALONE, leaves, pairs, settings.pruning)
        if _in_limbs(left, pairs) < _in_limbs(joints.left, pairs) - 1:
            continue
        fewer = tree_of_parts(body, left, joints.used, joints.part, confidence, settings)
        gone = len(left.dropped) - len(joints.left.dropped)
        if (~_shared_joints(fewer, others, body.size)).sum() > (~shared).sum() - gone:
            continue
        rise = _rise(joints, fewer)
        if rise <= (best.rise if best else RISE):
            best = _Without(fewer, rise)
    return best.joints if best else None


def _in_limbs(left: Pruned, pairs: LimbPairs) -> int:
    """How many parts are of limbs that have a mirror image; two fewer where two of them on one part become one."""
    return int(in_mirrored_limbs(RootedParts.of(left.parts.label, left.part_tree), pairs).sum())


def _shared_joints(joints: TreeJoints, others: Sequence[Floats], size: float) -> Flags:
    """(joint,) but for the root's, whether another cut has it."""
    return in_other_cuts(joints.motion.carried(joints.rest[1:]), others, size)


def _rise(before: TreeJoints, after: TreeJoints) -> float:
    """The largest drift of joints between parts that met in no joint before, in that of those that meet in none now.

    Infinite where no joint comes: what lay beyond is gone as well then.
    """
    old, new = _between(before, before.drift), _between(after, after.drift)
    gone, come = [old[pair] for pair in old.keys() - new.keys()], [new[pair] for pair in new.keys() - old.keys()]
    return float(max(come, default=np.inf) / max(*gone, np.finfo(float).tiny))


def _between(joints: TreeJoints, values: Floats) -> dict[frozenset[int], float]:
    """The value (part,) of every joint, by the parts that meet in it, as they were numbered before any was dropped."""
    tree = joints.left.part_tree.tree
    part = joints.left.origin[tree.order]
    return {frozenset((int(part[k]), int(part[tree.parents[k]]))): float(values[k]) for k in range(1, len(part))}


def _of_cut(tree: FirstTree, joints: TreeJoints) -> FirstTree:
    """The joints that are left as a tree of the same cut."""
    left = in_tree_order(joints, len(tree.parents))
    number = {int(joint): part for part, joint in enumerate(tree.place) if joint >= 0}
    gone = tuple(Dropped(number[d.part], d.reason) for d in left.graph.dropped if d.part in number)
    return left._replace(
        place=np.where(tree.place < 0, -1, left.place[tree.place]),
        graph=tree.graph._replace(dropped=(*tree.graph.dropped, *gone)),
    )
