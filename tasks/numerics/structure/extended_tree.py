"""A tree with the joints within the last parts of its limbs that the frames' surfaces show (ours, see `end_joints`)."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.end_joints import EndJoint
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.hinged_piece import on_pieces
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.rotation_centres import drift
from kinetree.tasks.numerics.structure.skinning import skinning


def extended_tree(
    body: MovingSurface, tree: FirstTree, ends: Sequence[EndJoint], confidence: Floats, noise: float
) -> FirstTree:
    """The tree with a part more beyond every joint at an end, after all others, and vertices there as the frames show them.

    ends       : one at least
    confidence : (frame, vertex) 0 to 1
    noise      : error of a vertex below which its motion says nothing of its skinning weights, mesh unit
    """
    x = moved_ends(body, tree, ends)
    count, label = len(tree.parents), tree.label.copy()
    for k, end in enumerate(ends, start=count):
        label[end.cut.own[end.cut.far]] = k
    nearer = [end.cut.part for end in ends]
    R, t = (_with_pieces(mine, [getattr(end, name) for end in ends], nearer) for mine, name in ((tree.R, "R"), (tree.t, "t")))
    beyond = np.stack([end.residual for end in ends], axis=1)
    unexplained = np.concatenate([tree.unexplained, beyond], axis=1)
    unexplained[:, nearer] = beyond
    parents = np.concatenate([tree.parents, nearer])
    share = confident_share(label, body.area, confidence, len(R), len(parents))
    centre = np.stack([end.cut.centre for end in ends])
    pair = np.stack([nearer, np.arange(count, len(parents))], axis=1)
    new = tree._replace(
        parents=parents,
        ends=len(ends),
        label=label,
        W=skinning(body.V, body.F, x, label, R, t, parents, confidence, noise),
        R=R,
        t=t,
        certain_share=share,
        rest=np.concatenate([tree.rest, centre]),
        drift=np.concatenate([tree.drift, drift(R, t, pair, centre, share)]),
        unexplained=unexplained,
        radius=np.append(tree.radius, [end.cut.radius for end in ends]),
    )
    return new._replace(end_x=x[:, new.at_ends])


def moved_ends(body: MovingSurface, tree: FirstTree, ends: Sequence[EndJoint]) -> Floats:
    """(frame, vertex, xyz) the aligned vertices, those of parts with a joint at an end where the frames have them."""
    x = body.x.copy()
    for end in ends:
        v, weight = end.cut.own, tree.W[end.cut.own, end.cut.part]
        for f in np.flatnonzero(end.visible):
            x[f, v] = on_pieces(body.V[v], x[f, v], weight, end.cut.share, end.R[f], end.t[f])
    return x


def _with_pieces(mine: Floats, pieces: Sequence[Floats], nearer: Sequence[int]) -> Floats:
    """(frame, part, …) what the pieces nearer to the body have in place of their part's, and those beyond after all others."""
    out = np.concatenate([mine, np.stack([piece[:, 1] for piece in pieces], axis=1)], axis=1)
    for piece, part in zip(pieces, nearer, strict=True):
        out[:, part] = piece[:, 0]
    return np.ascontiguousarray(out)
