"""All joints that the frames' surfaces show, at ends of limbs and within the trunk (ours, see `end_joints`).

Some joints of a cut are asked anew, since an alignment smears them: one of the trunk midway between two, one at the end of a
limb close to the joint before it, and one close to a joint of the trunk that the surfaces show.
"""

from collections.abc import Callable, Collection, Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.close_joints import are_as_good, close_joints
from kinetree.tasks.numerics.structure.end_joints import EndJoint, EndJointsSettings, end_joints, judged_runs
from kinetree.tasks.numerics.structure.end_rings import Fits, closer_rings, end_rings, laid_in_runs
from kinetree.tasks.numerics.structure.extended_tree import extended_tree
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.inertial_joints import without_inertial_joints
from kinetree.tasks.numerics.structure.joint_partners import joints_between_pairs
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS, LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import MIDWAY, SMEARED
from kinetree.tasks.numerics.structure.refitted_tree import refitted_tree
from kinetree.tasks.numerics.structure.smeared_ends import are_replaced, without_smeared_ends
from kinetree.tasks.numerics.structure.surface_evidence import (
    KnownFits,
    SurfaceEvidence,
    all_end_rings,
    of_mirrored_limbs,
    rooted,
)
from kinetree.tasks.numerics.structure.trunk_bends import amid_two, roomy_rings, with_joints_at_bends
from kinetree.tasks.numerics.structure.without_joint import without_joint


def with_end_joints(
    body: MovingSurface,
    tree: FirstTree,
    leaves: Ints,
    fits: Sequence[Fits],
    surface: Callable[[int], Target],
    confidence: Floats,
    noise: float,
) -> FirstTree:
    """The tree with all joints that the frames' surfaces show.

    Joints within limbs with a mirror image whose turn inertia explains go first (`without_inertial_joints`).
    The last joint of a limb with a mirror image that lies close to the one before, as a ball of the foot close to the ankle,
    goes first if the surfaces show one without it (`without_smeared_ends`).

    Where the trunk has a single joint between pairs of limbs, and the surfaces show no other beside it, it may lie midway
    between two. So they are asked again without it; if they show two or more, these take its place, and the limbs are asked
    anew. Elsewhere one that they show amid two must show beside these where they bend (`trunk_bends`), and a joint of the trunk
    close to one that surfaces show goes if these do as well without it (`close_joints`).

    leaves     : (leaf,) vertices at the ends of limbs
    fits       : by ring of `end_rings`, how its part lies in the frames of `end_joints.judged_runs`
    surface    : gives a frame's surface, prepared, by its place among all frames
    confidence : (frame, vertex) 0 to 1
    noise      : see `extended_tree`
    """
    pairs, evidence = limb_pairs(body.V, body.F, leaves), SurfaceEvidence(surface, confidence, noise)
    known = KnownFits.of(all_end_rings(body.V, body.F, body.area, tree, pairs), fits)
    tree = without_inertial_joints(body, tree, pairs, evidence)
    left = without_smeared_ends(body, tree, known, pairs, evidence)
    extended = _with_shown_joints(body, left, known, pairs, evidence)
    if not are_replaced(tree, left, extended):
        left, extended = tree, _with_shown_joints(body, tree, known, pairs, evidence)
    tree, extended = _with_settled_trunk(body, left, extended, known, pairs, evidence)
    single = joints_between_pairs(rooted(tree), pairs)
    if len(single) != 1 or len(joints_between_pairs(rooted(extended), pairs)) != 1:
        without = _without_close_joints(body, tree, extended, pairs, evidence)
        if without is not extended:
            return without
        return _with_settled_trunk(body, tree, extended, known, pairs, evidence, are_needed=True)[1]
    divided = _with_trunk_divided_anew(body, tree, int(single[0]), pairs, evidence)
    if divided is None:
        return extended
    divided = _with_shown_joints(divided.with_ends(body), divided, KnownFits({}), pairs, evidence)
    return divided if len(divided.parents) > len(extended.parents) else extended


def _with_settled_trunk(
    body: MovingSurface,
    tree: FirstTree,
    extended: FirstTree,
    known: KnownFits,
    pairs: LimbPairs,
    evidence: SurfaceEvidence,
    *,
    are_needed: bool = False,
) -> tuple[FirstTree, FirstTree]:
    """The tree and the extended one; where surfaces show a joint amid two of the trunk, these two are where they bend, first.

    So flesh of a neighbour shows no joint, nor does flesh that bends between two joints (`roomy_rings`).

    are_needed : see `trunk_bends.BOTH_SIDES`
    """
    trunk = joints_between_pairs(rooted(tree), pairs)
    if len(trunk) < 2 or not amid_two(extended, pairs):
        return tree, extended
    settled = with_joints_at_bends(body, tree, trunk.tolist(), evidence, are_needed=are_needed)
    if settled is None:
        return tree, extended
    return settled, _with_shown_joints(body, settled, known, pairs, evidence, roomy=True)


def _without_close_joints(
    body: MovingSurface, tree: FirstTree, extended: FirstTree, pairs: LimbPairs, evidence: SurfaceEvidence
) -> FirstTree:
    """The extended tree without joints of the trunk that those which surfaces show do as well without (`close_joints`).

    Where these show another one in such a joint's place, that must lie a radius from both beside it (`roomy_rings`).
    """
    for joint in close_joints(tree, extended, pairs):
        one, known = without_joint(body, tree, joint, evidence, SMEARED), KnownFits({})
        without = _with_shown_joints(body, one, known, pairs, evidence)
        if len(without.parents) == len(extended.parents):
            without = _with_shown_joints(body, one, known, pairs, evidence, roomy=True)
        if len(without.parents) < len(extended.parents) and are_as_good(body.area, extended, without, pairs):
            return _without_close_joints(body, one, without, pairs, evidence)
    return extended


def _with_trunk_divided_anew(
    body: MovingSurface, tree: FirstTree, joint: int, pairs: LimbPairs, evidence: SurfaceEvidence
) -> FirstTree | None:
    """The tree with the joints of the trunk that surfaces show in place of one; None where these are not two."""
    one = without_joint(body, tree, joint, evidence, MIDWAY)
    own = np.flatnonzero(np.isin(tree.label, [joint, tree.parents[joint]]))
    frames, runs = evidence.frames(body, one), judged_runs(len(body.x), body.takes, EndJointsSettings())
    rings = end_rings(body.V, body.F, body.area, one, of_mirrored_limbs(one, pairs))
    rings = [ring for ring in rings if ring.cut.part == one.label[own[0]]]
    found = end_joints(frames, rings, laid_in_runs(frames, runs, rings), body.takes)
    after = _with_closer_joints(body, one, found, own, pairs, evidence, stays=True)
    trunk = joints_between_pairs(rooted(after), pairs)
    return _with_ends_of_trunk_as_aligned(body, after, trunk, evidence) if len(trunk) > 1 else None


def _with_ends_of_trunk_as_aligned(body: MovingSurface, tree: FirstTree, trunk: Ints, evidence: SurfaceEvidence) -> FirstTree:
    """The tree whose first and last part of the trunk move as their aligned vertices do.

    Limbs hang on these two, which were well aligned before the trunk was divided. Their motions by the frames' surfaces are
    less certain: limbs' joints drift three times as far there (RESULTS, "A single joint of the trunk"). A part from which
    limbs were cut off stays as the surfaces have it, since the alignment does not tell it from them.

    body  : as it was aligned
    trunk : the joints between pairs of limbs
    """
    meets = np.bincount(np.concatenate([trunk, tree.parents[trunk]]), minlength=len(tree.parents))
    carries_shown = tree.parents[np.setdiff1d(tree.shown, trunk).astype(np.int64)]
    ends = np.setdiff1d(np.flatnonzero(meets == 1), carries_shown)
    if not len(ends):
        return tree
    x, share = tree.with_ends(body).x, tree.W[:, ends].sum(axis=1)
    x = x + share[:, None] * (body.x - x)
    new = refitted_tree(body, tree, ends.tolist(), evidence, body._replace(x=x))
    return new._replace(unexplained=np.maximum(new.unexplained, tree.unexplained), end_x=x[:, tree.at_ends])


def _with_shown_joints(
    body: MovingSurface,
    tree: FirstTree,
    known: KnownFits,
    pairs: LimbPairs,
    evidence: SurfaceEvidence,
    *,
    roomy: bool = False,
) -> FirstTree:
    """The tree with the joints that the frames' surfaces show beside its own.

    The trunk is asked once more with rings that lie closer together: between those of `end_rings` a joint may be missed, and a
    part that one joint divides may hold two.

    roomy : whether rings between two joints of the trunk must lie far from both (`roomy_rings`)
    """
    chosen = _settings(tree, pairs)
    rings, frames = all_end_rings(body.V, body.F, body.area, tree, pairs), evidence.frames(body, tree)
    rings = roomy_rings(tree, rings, pairs) if roomy else rings
    fits = known.laid(frames, judged_runs(len(body.x), body.takes, chosen), rings)
    found = end_joints(frames, rings, fits, body.takes, chosen)
    return _with_closer_joints(body, tree, found, np.arange(len(body.V)), pairs, evidence, roomy=roomy)


def _with_closer_joints(
    body: MovingSurface,
    tree: FirstTree,
    found: Sequence[EndJoint],
    own: Ints,
    pairs: LimbPairs,
    evidence: SurfaceEvidence,
    *,
    stays: bool = False,
    roomy: bool = False,
) -> FirstTree:
    """The tree with some joints, and with those that rings closer together show across the trunk then; the pieces of what is
    divided, and the parts beside them, are asked until they show no other joint.

    own   : (own,) vertices whose parts are asked first, with those beside them
    stays : whether these are asked always, and nothing else
    roomy : see `_with_shown_joints`
    """
    runs = judged_runs(len(body.x), body.takes, EndJointsSettings())
    while True:
        if found:
            tree = extended_tree(body, tree, found, evidence.confidence, evidence.noise)
            body = tree.with_ends(body)
        chosen = _settings(tree, pairs)
        closer = chosen._replace(evident=chosen.evident._replace(least_apart=chosen.evident.least_apart_if_closer))
        mirrored, frames = of_mirrored_limbs(tree, pairs), evidence.frames(body, tree)
        parts = np.unique(tree.label[own])
        asked = parts.tolist() if stays else _with_neighbours(tree, parts)
        limbs = pairs if found and not stays else NO_PAIRS
        rings = closer_rings(body.V, body.F, body.area, tree, mirrored, asked, limbs)
        rings = roomy_rings(tree, rings, pairs) if roomy else rings
        found = end_joints(frames, rings, laid_in_runs(frames, runs, rings), body.takes, closer)
        if not found:
            return tree
        if not stays:
            own = np.concatenate([one.cut.own for one in found])


def _settings(tree: FirstTree, pairs: LimbPairs) -> EndJointsSettings:
    """What rings must show: across a trunk that has two joints between pairs of limbs, more."""
    chosen = EndJointsSettings()
    if len(joints_between_pairs(rooted(tree), pairs)) < 2:
        return chosen
    return chosen._replace(evident=chosen.evident._replace(least_score_in_trunk=chosen.evident.least_score_if_divided))


def _with_neighbours(tree: FirstTree, parts: Ints) -> Collection[int]:
    """Parts, those that they hang on, and those that hang on them."""
    beside = np.isin(tree.parents, parts)
    return {*parts.tolist(), *tree.parents[parts].tolist(), *np.flatnonzero(beside).tolist()} - {-1}
