"""All joints that the frames' surfaces show, at ends of limbs and within the trunk (ours, see `end_joints`)."""

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.agreed_tree import with_one_fewer
from kinetree.tasks.numerics.structure.end_joints import EndJointsSettings, end_joints, judged_runs
from kinetree.tasks.numerics.structure.end_rings import EndFrames, Fits, closer_rings, end_rings, laid_in_runs
from kinetree.tasks.numerics.structure.extended_tree import extended_tree
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import RootedParts, in_mirrored_limbs, joints_between_pairs
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS, LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.limbs_apart import moving_by_themselves
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.tree_joints import KinematicTreeSettings


class Asked(NamedTuple):
    """What the joints of a tree are asked of.

    pairs      : ends of limbs that are mirror images
    surface    : gives a frame's surface, prepared, by its place among all frames
    confidence : (frame, vertex) 0 to 1
    noise      : see `extended_tree`
    """

    pairs: LimbPairs
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
    *,
    settings: KinematicTreeSettings,
) -> FirstTree:
    """The tree with all joints that the frames' surfaces show.

    If a cut has a single joint between pairs of limbs and the surfaces show no other, it may lie midway between two. So the
    surfaces are asked again without it, and where they show two, it goes.

    leaves     : (leaf,) vertices at the ends of limbs
    fits       : by ring of `end_rings`, how its part lies in the frames of `end_joints.judged_runs`
    surface    : gives a frame's surface, prepared, by its place among all frames
    confidence : (frame, vertex) 0 to 1
    """
    pairs = limb_pairs(body.V, body.F, leaves)
    asked = Asked(pairs, surface, confidence, settings.noise * body.size)
    once = _with_shown_joints(body, tree, fits, asked)
    single = joints_between_pairs(_rooted(tree), pairs)
    if len(single) != 1 or len(joints_between_pairs(_rooted(once), pairs)) != 1:
        return once
    without = with_one_fewer(body, tree, int(single[0]), confidence, settings)
    again = _with_shown_joints(body, without, None, asked)
    between = joints_between_pairs(_rooted(again), pairs)
    return _with_ends_of_trunk_as_aligned(body, again, between, asked) if len(between) > 1 else once


def _with_ends_of_trunk_as_aligned(body: MovingSurface, tree: FirstTree, between: Ints, asked: Asked) -> FirstTree:
    """The tree whose first and last part of the trunk move as their aligned vertices do: with the limbs that hang on them these
    were a part before as well, and surfaces hold two pieces at once less firmly.

    body    : as it was aligned
    between : the joints of the trunk
    """
    met = np.bincount(np.concatenate([between, tree.parents[between]]), minlength=len(tree.parents))
    ends = np.flatnonzero(met == 1)
    parts = MovingParts(tree.label, tree.R, tree.t, tree.unexplained, tree.certain_share)
    R, t, residual = moving_by_themselves(body, parts, ends.tolist(), asked.confidence)[1:4]
    x = tree.with_ends(body).x.copy()
    own = np.isin(tree.label, ends)
    x[:, own] = body.x[:, own]
    W = skinning(body.V, body.F, x, tree.label, R, t, tree.parents, asked.confidence, asked.noise)
    new = tree._replace(R=R, t=t, unexplained=residual, W=W, end_x=x[:, tree.at_ends])
    beside = np.isin(np.arange(len(met)), ends) | np.isin(tree.parents, ends)
    return new._replace(drift=np.where(beside, new.drift_at(new.rest), tree.drift))


def _with_shown_joints(body: MovingSurface, tree: FirstTree, fits: Sequence[Fits] | None, asked: Asked) -> FirstTree:
    """The tree with the joints that the frames' surfaces show, as it is.

    The trunk is asked once more with rings that lie closer together: between those of `end_rings` a joint may be missed, and a
    part that one joint divides may hold two. The pieces of what is divided then, and the parts beside them, are asked until
    they show no other joint.

    fits : see `with_end_joints`; None has them laid
    """
    (pairs, surface, confidence, noise), chosen = asked, EndJointsSettings()
    mirrored, ends = _in_mirrored_limbs(tree, pairs), np.unique(tree.label[pairs.tip])
    rings, frames = end_rings(body.V, body.F, body.area, tree, mirrored, pairs), _frames(body, tree, surface, confidence)
    runs = judged_runs(len(body.x), body.takes, chosen)
    fits = laid_in_runs(frames, runs, rings) if fits is None else fits
    found = end_joints(frames, rings, fits, body.takes, ends[mirrored[ends]].tolist(), chosen)
    closer = chosen._replace(evident=chosen.evident._replace(least_apart=chosen.evident.least_apart_if_closer))
    own = np.arange(len(body.V))
    while True:
        if found:
            tree = extended_tree(body, tree, found, confidence, noise)
            body = tree.with_ends(body)
        mirrored, frames = _in_mirrored_limbs(tree, pairs), _frames(body, tree, surface, confidence)
        rings = closer_rings(
            body.V, body.F, body.area, tree, mirrored, _with_neighbours(tree, tree.label[own]), pairs if found else NO_PAIRS
        )
        found = end_joints(frames, rings, laid_in_runs(frames, runs, rings), body.takes, settings=closer)
        if not found:
            return tree
        own = np.concatenate([one.cut.own for one in found])


def _with_neighbours(tree: FirstTree, parts: Ints) -> Collection[int]:
    """Parts, those that they hang on, and those that hang on them."""
    beside = np.isin(tree.parents, parts)
    return {*parts.tolist(), *tree.parents[parts].tolist(), *np.flatnonzero(beside).tolist()} - {-1}


def _frames(body: MovingSurface, tree: FirstTree, surface: Callable[[int], Target], confidence: Floats) -> EndFrames:
    """All frames."""
    return EndFrames.of(tree, body.area, np.arange(len(confidence)), confidence, surface)


def _in_mirrored_limbs(tree: FirstTree, pairs: LimbPairs) -> Flags:
    """(part,) whether a part is of a limb that has a mirror image."""
    return in_mirrored_limbs(_rooted(tree), pairs)


def _rooted(tree: FirstTree) -> RootedParts:
    return RootedParts(tree.label, tree.parents, tree.radius)
