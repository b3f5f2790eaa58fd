"""All joints that the frames' surfaces show, at ends of limbs and within the trunk (ours, see `end_joints`)."""

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_joints import EndJoint, EndJointsSettings, end_joints, judged_runs
from kinetree.tasks.numerics.structure.end_rings import EndFrames, Fits, closer_rings, end_rings, laid_in_runs
from kinetree.tasks.numerics.structure.extended_tree import extended_tree
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import RootedParts, in_mirrored_limbs, joints_between_pairs
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS, LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.limbs_apart import moving_by_themselves
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface
from kinetree.tasks.numerics.structure.pruning import MIDWAY, Dropped
from kinetree.tasks.numerics.structure.skinning import skinning


class SurfaceEvidence(NamedTuple):
    """What shows joints.

    surface    : gives a frame's surface, prepared, by its place among all frames
    confidence : (frame, vertex) 0 to 1
    noise      : see `extended_tree`
    """

    surface: Callable[[int], Target]
    confidence: Floats
    noise: float


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

    Where the trunk has a single joint between pairs of limbs, and the surfaces show no other beside it, it may lie midway
    between two. So they are asked again without it; if they show two or more, these take its place, and the limbs are asked
    anew.

    leaves     : (leaf,) vertices at the ends of limbs
    fits       : by ring of `end_rings`, how its part lies in the frames of `end_joints.judged_runs`
    surface    : gives a frame's surface, prepared, by its place among all frames
    confidence : (frame, vertex) 0 to 1
    noise      : see `extended_tree`
    """
    pairs, evidence = limb_pairs(body.V, body.F, leaves), SurfaceEvidence(surface, confidence, noise)
    extended = _with_shown_joints(body, tree, fits, pairs, evidence)
    single = joints_between_pairs(_rooted(tree), pairs)
    if len(single) != 1 or len(joints_between_pairs(_rooted(extended), pairs)) != 1:
        return extended
    divided = _with_trunk_divided_anew(body, tree, int(single[0]), pairs, evidence)
    if divided is None:
        return extended
    divided = _with_shown_joints(divided.with_ends(body), divided, None, pairs, evidence)
    return divided if len(divided.parents) > len(extended.parents) else extended


def _with_trunk_divided_anew(
    body: MovingSurface, tree: FirstTree, joint: int, pairs: LimbPairs, evidence: SurfaceEvidence
) -> FirstTree | None:
    """The tree with the joints of the trunk that surfaces show in place of one; None where these are not two."""
    one = without_joint(body, tree, joint, evidence)
    own = np.flatnonzero(np.isin(tree.label, [joint, tree.parents[joint]]))
    frames, runs = _frames(body, one, evidence), judged_runs(len(body.x), body.takes, EndJointsSettings())
    rings = end_rings(body.V, body.F, body.area, one, _in_mirrored_limbs(one, pairs))
    rings = [ring for ring in rings if ring.cut.part == one.label[own[0]]]
    found = end_joints(frames, rings, laid_in_runs(frames, runs, rings), body.takes, settings=EndJointsSettings())
    after = _with_closer_joints(body, one, found, own, pairs, evidence, stays=True)
    trunk = joints_between_pairs(_rooted(after), pairs)
    return _with_ends_of_trunk_as_aligned(body, after, trunk, evidence) if len(trunk) > 1 else None


def without_joint(body: MovingSurface, tree: FirstTree, joint: int, evidence: SurfaceEvidence) -> FirstTree:
    """The tree with the two parts of a joint as one, which moves as the one above did; all other joints stay where they are.

    What moves otherwise follows the part less (`skinning`) and counts less across its rings. So these tell first where that
    begins, which is at one end of what lies between two joints, and not midway.

    tree  : without joints that surfaces alone show
    joint : by the part that turns about it, not the root
    """
    above, others = int(tree.parents[joint]), np.arange(len(tree.parents)) != joint
    number = np.cumsum(others) - 1
    number[joint] = number[above]
    gone = tuple(Dropped(int(part), MIDWAY) for part in np.flatnonzero(tree.place == joint))
    parents, label = tree.parents[others], number[tree.label]
    parents = np.where(parents < 0, -1, number[parents])
    R, t = (np.ascontiguousarray(a[:, others]) for a in (tree.R, tree.t))
    left = tree._replace(
        parents=parents,
        place=np.where((tree.place < 0) | (tree.place == joint), -1, number[tree.place]),
        label=label,
        W=skinning(body.V, body.F, body.x, label, R, t, parents, evidence.confidence, evidence.noise),
        R=R,
        t=t,
        certain_share=None if tree.certain_share is None else tree.certain_share[:, others],
        rest=tree.rest[others],
        unexplained=tree.unexplained[:, others],
        radius=tree.radius[others],
        graph=tree.graph._replace(dropped=(*tree.graph.dropped, *gone)),
    )
    return left._replace(drift=np.where(parents == number[above], left.drift_at(left.rest), tree.drift[others]))


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
    parts = MovingParts(tree.label, tree.R, tree.t, tree.unexplained, tree.certain_share)
    fitted = moving_by_themselves(body, parts, ends.tolist(), evidence.confidence)
    x, share = tree.with_ends(body).x, tree.W[:, ends].sum(axis=1)
    x = x + share[:, None] * (body.x - x)
    W = skinning(body.V, body.F, x, tree.label, fitted.R, fitted.t, tree.parents, evidence.confidence, evidence.noise)
    unexplained = np.maximum(fitted.residual, tree.unexplained)
    new = tree._replace(R=fitted.R, t=fitted.t, unexplained=unexplained, W=W, end_x=x[:, tree.at_ends])
    beside = np.isin(np.arange(len(meets)), ends) | np.isin(tree.parents, ends)
    return new._replace(drift=np.where(beside, new.drift_at(new.rest), tree.drift))


def _with_shown_joints(
    body: MovingSurface, tree: FirstTree, fits: Sequence[Fits] | None, pairs: LimbPairs, evidence: SurfaceEvidence
) -> FirstTree:
    """The tree with the joints that the frames' surfaces show beside its own.

    The trunk is asked once more with rings that lie closer together: between those of `end_rings` a joint may be missed, and a
    part that one joint divides may hold two.

    fits : see `with_end_joints`; None has them laid
    """
    chosen, mirrored = EndJointsSettings(), _in_mirrored_limbs(tree, pairs)
    rings, frames = end_rings(body.V, body.F, body.area, tree, mirrored, pairs), _frames(body, tree, evidence)
    if fits is None:
        fits = laid_in_runs(frames, judged_runs(len(body.x), body.takes, chosen), rings)
    ends = np.unique(tree.label[pairs.tip])
    found = end_joints(frames, rings, fits, body.takes, ends[mirrored[ends]].tolist(), chosen)
    return _with_closer_joints(body, tree, found, np.arange(len(body.V)), pairs, evidence)


def _with_closer_joints(
    body: MovingSurface,
    tree: FirstTree,
    found: Sequence[EndJoint],
    own: Ints,
    pairs: LimbPairs,
    evidence: SurfaceEvidence,
    *,
    stays: bool = False,
) -> FirstTree:
    """The tree with some joints, and with those that rings closer together show across the trunk then; the pieces of what is
    divided, and the parts beside them, are asked until they show no other joint.

    own   : (own,) vertices whose parts are asked first, with those beside them
    stays : whether these are asked always, and nothing else
    """
    chosen = EndJointsSettings()
    closer = chosen._replace(evident=chosen.evident._replace(least_apart=chosen.evident.least_apart_if_closer))
    runs = judged_runs(len(body.x), body.takes, chosen)
    while True:
        if found:
            tree = extended_tree(body, tree, found, evidence.confidence, evidence.noise)
            body = tree.with_ends(body)
        mirrored, frames = _in_mirrored_limbs(tree, pairs), _frames(body, tree, evidence)
        parts = np.unique(tree.label[own])
        asked = parts.tolist() if stays else _with_neighbours(tree, parts)
        limbs = pairs if found and not stays else NO_PAIRS
        rings = closer_rings(body.V, body.F, body.area, tree, mirrored, asked, limbs)
        found = end_joints(frames, rings, laid_in_runs(frames, runs, rings), body.takes, settings=closer)
        if not found:
            return tree
        if not stays:
            own = np.concatenate([one.cut.own for one in found])


def _with_neighbours(tree: FirstTree, parts: Ints) -> Collection[int]:
    """Parts, those that they hang on, and those that hang on them."""
    beside = np.isin(tree.parents, parts)
    return {*parts.tolist(), *tree.parents[parts].tolist(), *np.flatnonzero(beside).tolist()} - {-1}


def _frames(body: MovingSurface, tree: FirstTree, evidence: SurfaceEvidence) -> EndFrames:
    """All frames."""
    return EndFrames.of(tree, body.area, np.arange(len(body.x)), evidence.confidence, evidence.surface)


def _in_mirrored_limbs(tree: FirstTree, pairs: LimbPairs) -> Flags:
    """(part,) whether a part is of a limb that has a mirror image."""
    return in_mirrored_limbs(_rooted(tree), pairs)


def _rooted(tree: FirstTree) -> RootedParts:
    """Its parts alone."""
    return RootedParts(tree.label, tree.parents, tree.radius)
