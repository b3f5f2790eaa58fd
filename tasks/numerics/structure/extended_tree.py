"""A tree with the joints at ends of limbs and within the trunk that the frames' surfaces show (ours, see `end_joints`)."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.end_joints import EndJoint
from kinetree.tasks.numerics.structure.evident_rings import joint_inwards
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.hinged_piece import on_pieces
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.root_place import root_amid_limbs
from kinetree.tasks.numerics.structure.rotation_centres import rotation_centres
from kinetree.tasks.numerics.structure.skinning import skinning

NEAREST = 20
"""One in so many of the root's vertices, those nearest to its place, says on which side of a ring it lies."""


def extended_tree(
    body: MovingSurface, tree: FirstTree, found: Sequence[EndJoint], confidence: Floats, noise: float
) -> FirstTree:
    """The tree with a part more beyond every joint that the surfaces show, and vertices there as the frames show them.

    A part at an end comes after all others. One within the trunk carries the parts that hang on it, and comes before them.

    found      : one at least
    confidence : (frame, vertex) 0 to 1
    noise      : error of a vertex below which its motion says nothing of its skinning weights, mesh unit
    """
    x = moved_ends(body, tree, found)
    count, label, parents = len(tree.parents), tree.label.copy(), np.append(tree.parents, [one.cut.part for one in found])
    stays = [_keeps_root(body.V, tree, one) for one in found]
    for k, (one, is_beyond) in enumerate(zip(found, stays, strict=True), start=count):
        label[one.cut.own[one.cut.far ^ is_beyond]] = k
        hung = np.isin(np.arange(len(parents)), one.cut.hung)
        parents[(hung ^ is_beyond) & (parents == one.cut.part) & (np.arange(len(parents)) < count)] = k
    order = _parts_after_parents(parents, [k for k, one in enumerate(found, start=count) if not one.cut.hung])
    place = np.argsort(order)
    nearer = [one.cut.part for one in found]
    pieces = [
        (mine, [a[:, ::-1] if is_beyond else a for a, is_beyond in zip(theirs, stays, strict=True)])
        for mine, theirs in ((tree.R, [one.R for one in found]), (tree.t, [one.t for one in found]))
    ]
    R, t = (np.ascontiguousarray(_with_pieces(mine, theirs, nearer)[:, order]) for mine, theirs in pieces)
    beyond = np.stack([one.residual for one in found], axis=1)
    unexplained = np.concatenate([tree.unexplained, beyond], axis=1)
    unexplained[:, nearer] = beyond
    parents = np.where(parents[order] < 0, -1, place[parents[order]])
    label = place[label]
    share = confident_share(label, body.area, confidence, len(R), len(parents))
    new = tree._replace(
        parents=parents,
        place=np.where(tree.place < 0, -1, place[tree.place]),
        shown=tuple(sorted(place[[*tree.shown, *range(count, len(place))]].tolist())),
        label=label,
        W=skinning(body.V, body.F, x, label, R, t, parents, confidence, noise),
        R=R,
        t=t,
        certain_share=share,
        rest=np.concatenate([tree.rest, np.stack([one.cut.centre for one in found])])[order],
        drift=np.append(tree.drift, np.zeros(len(found)))[order],
        unexplained=unexplained[:, order],
        radius=np.append(tree.radius, [one.cut.radius for one in found])[order],
    )
    limbs = [one.cut for one in found if one.cut.is_across_limb]
    beside = np.array(sorted({place[joint_inwards(tree, cut)] for cut in limbs}), np.int64)
    new.rest[beside] = _turning_about(new, beside)
    if any(tree.parents[cut.part] < 0 for cut in limbs):
        new.rest[0] = root_amid_limbs(new.rest, new.parents, new.rest[0])
    moved = {*new.shown, *parents[list(new.shown)].tolist()}
    changed = np.array([k for k in range(1, len(parents)) if k in moved or parents[k] in moved])
    drifts = new.drift.copy()
    drifts[changed] = new.drift_at(new.rest)[changed]
    return new._replace(drift=drifts, end_x=x[:, new.at_ends])


def _turning_about(tree: FirstTree, joints: Ints) -> Floats:
    """(joint, xyz) where the motions of both parts have some joints, mesh unit."""
    pair, radius = np.stack([joints, tree.parents[joints]], axis=1), tree.radius[joints]
    return rotation_centres(tree.R, tree.t, pair, tree.rest[joints], radius, tree.unexplained, tree.certain_share).rest


def _keeps_root(V: Floats, tree: FirstTree, one: EndJoint) -> bool:
    """Whether the piece beyond a ring stays the part, and the other one hangs on it: where the root's place lies beyond, and
    where a limb is cut off.
    """
    cut = one.cut
    if cut.is_across_limb or tree.parents[cut.part] >= 0:
        return cut.is_across_limb
    away = np.linalg.norm(V[cut.own] - tree.rest[cut.part], axis=1)
    nearest = np.argsort(away, kind="stable")[: max(len(away) // NEAREST, 1)]
    return bool(cut.far[nearest].mean() > 0.5)


def _parts_after_parents(parents: Ints, last: Sequence[int]) -> Ints:
    """(part,) the parts in an order in which each comes after its parent; as they were where that is so, `last` ones last.

    parents : (part,) −1 for the root
    """
    order: list[int] = []
    waiting = [k for k in range(len(parents)) if k not in last]
    while waiting:
        following = next(k for k in waiting if parents[k] < 0 or parents[k] in order)
        order.append(following)
        waiting.remove(following)
    return np.array([*order, *last], np.int64)


def moved_ends(body: MovingSurface, tree: FirstTree, ends: Sequence[EndJoint]) -> Floats:
    """(frame, vertex, xyz) the aligned vertices, those of parts with a ring that is a joint where the frames have them."""
    x, is_moved = body.x.copy(), np.zeros(body.x.shape[:2], np.bool_)
    for end in ends:
        v, share = end.cut.own, end.cut.share
        weight, V = tree.W[v, end.cut.part], body.V[v]
        for f in np.flatnonzero(end.visible):
            near, far = (V @ R.T + t for R, t in zip(end.R[f], end.t[f], strict=True))
            both = x[f, v] + (weight * (1.0 - share))[:, None] * (near - far)  # the ring across the other limb moved it
            x[f, v] = np.where(is_moved[f, v, None], both, on_pieces(V, x[f, v], weight, share, end.R[f], end.t[f]))
            is_moved[f, v] = True
    return x


def _with_pieces(mine: Floats, pieces: Sequence[Floats], nearer: Sequence[int]) -> Floats:
    """(frame, part, …) what the pieces nearer to the body have in place of their part's, and those beyond after all others."""
    out = np.concatenate([mine, np.stack([piece[:, 1] for piece in pieces], axis=1)], axis=1)
    for piece, part in zip(pieces, nearer, strict=True):
        out[:, part] = piece[:, 0]
    return out
