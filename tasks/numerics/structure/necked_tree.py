"""The tree with a bone in every neck that the shape alone shows (ours, see `necks`)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.blended_bone import MovingSkin
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hidden_bones import Border, half_way
from kinetree.tasks.numerics.structure.necks import Neck
from kinetree.tasks.numerics.structure.part_tree import MovingSurface


class PlacedJoints(NamedTuple):
    """What is known of the joints of a tree.

    rest     : (part, xyz) in the reference, mesh unit
    offset   : (part,) see `SurfaceJoints`
    spread   : (part,) see `JointConsensus`
    agreeing : (part,) cuts that have each
    """

    rest: Floats
    offset: Floats
    spread: Floats
    agreeing: Ints


def necked_tree(
    body: MovingSurface, tree: FirstTree, joints: PlacedJoints, necks: Sequence[Neck]
) -> tuple[FirstTree, PlacedJoints, Flags]:
    """The tree with every neck right before the part that hangs on it · its joints · (part,) which of them are new.

    A neck turns half as far as its part: the surface says nothing of it. The joint at its free end is new, the one at its other
    end is that which the part had.

    body  : its positions are those that the joints were found in
    necks : one at least, by part
    """
    below = np.array([neck.part for neck in necks])
    place = np.arange(len(tree.parents)) + np.searchsorted(below, np.arange(len(tree.parents)), side="right")
    own = place[below] - 1
    parents = np.insert(np.where(tree.parents < 0, -1, place[tree.parents]), below, 0)
    parents[own], parents[own + 1] = parents[own + 1], own
    skin = MovingSkin(body.V, body.x, body.area, tree.W, tree.R, tree.t)
    motion = [half_way(skin, _border(tree, joints, neck)) for neck in necks]
    label, W = _skinned(tree, necks, place, below)
    share = tree.certain_share
    new = tree._replace(
        parents=parents,
        place=np.where(tree.place < 0, -1, place[tree.place]),
        label=label,
        W=W,
        R=np.ascontiguousarray(np.insert(tree.R, below, np.stack([R for R, _ in motion], axis=1), axis=1)),
        t=np.ascontiguousarray(np.insert(tree.t, below, np.stack([t for _, t in motion], axis=1), axis=1)),
        certain_share=None if share is None else np.insert(share, below, share[:, below], axis=1),
        unexplained=np.insert(tree.unexplained, below, tree.unexplained[:, below], axis=1),
        radius=np.insert(tree.radius, below, [neck.radius for neck in necks]),
    )
    at = own + np.array([0 if neck.above else 1 for neck in necks])
    rest, offset, spread = (np.insert(a, below, a[below], axis=0) for a in joints[:3])
    placed = PlacedJoints(rest, offset, spread, np.insert(joints.agreeing, below, joints.agreeing[below]))
    placed.rest[at], placed.offset[at], placed.spread[at], placed.agreeing[at] = [k.centre for k in necks], np.nan, np.nan, 1
    is_new = np.isin(np.arange(len(parents)), at)
    new = new._replace(rest=placed.rest)
    return new._replace(drift=new.drift_at(placed.rest)), placed, is_new


def _border(tree: FirstTree, joints: PlacedJoints, neck: Neck) -> Border:
    """The joint that the part of a neck has without it."""
    k = neck.part
    return Border(k, int(tree.parents[k]), joints.rest[k], float(tree.radius[k]), float(tree.drift[k]))


def _skinned(tree: FirstTree, necks: Sequence[Neck], place: Ints, below: Ints) -> tuple[Ints, Floats]:
    """(vertex,) part · (vertex, part) skinning weights: skin on a tube follows the neck instead of the parts on both sides."""
    label, W = place[tree.label], np.insert(tree.W, below, 0.0, axis=1)
    for neck in necks:
        k, both = neck.part, [neck.part, int(tree.parents[neck.part])]
        old = place[both]
        W[:, place[k] - 1] = neck.share * W[:, old].sum(axis=1)
        W[:, old] *= 1.0 - neck.share[:, None]
        label[(neck.share > 0.5) & np.isin(tree.label, both)] = place[k] - 1
    return label, W
