"""A tree with the joints within the last parts of its limbs that the frames' surfaces show (ours, see `end_joints`)."""

from collections.abc import Callable, Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.end_joints import EndJoint, end_joints
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.hinged_piece import on_pieces
from kinetree.tasks.numerics.structure.inserted_bones import NO_PART
from kinetree.tasks.numerics.structure.joint_rotations import widest_turning_range
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree
from kinetree.tasks.numerics.structure.rotation_centres import Borders, Joints, drift
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.spanning_tree import RootedTree
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints, both_residuals


def inserted_ends(
    body: MovingSurface, found: TreeJoints, confidence: Floats, surface: Callable[[int], Target], noise: float
) -> tuple[MovingSurface, TreeJoints]:
    """The same tree with a part more beyond every such joint, and the surface with these parts where the frames show them.

    confidence : (frame, vertex) 0 to 1
    surface    : gives a frame's surface, prepared, by its place among the frames
    noise      : error of a vertex below which its motion says nothing of its skinning weights, mesh unit
    """
    ends = end_joints(body, found, confidence, surface)
    if not ends:
        return body, found
    x = body.x.copy()
    for end in ends:
        v, weight = end.cut.own, found.W[end.cut.own, end.cut.part]
        for f in np.flatnonzero(end.shown):
            x[f, v] = on_pieces(body.V[v], x[f, v], weight, end.cut.share, end.R[f], end.t[f])
    body = body._replace(x=x)
    return body, _extended(body, found, ends, confidence, noise)


def _extended(body: MovingSurface, found: TreeJoints, ends: Sequence[EndJoint], confidence: Floats, noise: float) -> TreeJoints:
    """The tree with new parts after all others; numbers of parts and borders go on likewise."""
    old, parts = found.left.part_tree, found.left.parts
    tree = _extended_tree(old, ends)
    label, number = found.label.copy(), parts.label.copy()
    for k, end in enumerate(ends, start=len(found.rest)):
        label[end.cut.own[end.cut.far]] = number[end.cut.own[end.cut.far]] = k
    R, t = (_with_pieces(mine, [getattr(end, name) for end in ends], ends) for mine, name in ((found.R, "R"), (found.t, "t")))
    nearer, beyond = tree.order[[end.cut.part for end in ends]], [end.residual for end in ends]
    residual = np.concatenate([parts.residual, np.stack(beyond, axis=1)], axis=1)
    residual[:, nearer] = np.stack(beyond, axis=1)
    by_number = np.argsort(tree.order)
    share = confident_share(number, body.area, confidence, len(R), len(tree.order))
    moving = MovingParts(number, R[:, by_number], t[:, by_number], residual, share)
    centre = np.stack([end.cut.centre for end in ends])
    pair = np.stack([tree.order[tree.parents[len(found.rest) :]], tree.order[len(found.rest) :]], axis=1)
    off = drift(moving.R, moving.t, pair, centre, share)
    left = found.left._replace(
        parts=moving,
        part_tree=_extended_part_tree(body, old, tree, moving, ends, off),
        origin=np.concatenate([found.left.origin, np.full(len(ends), NO_PART)]),
    )
    W = skinning(body.V, body.F, body.x, label, R, t, tree.parents, confidence, noise)
    rest, drifts = np.concatenate([found.rest, centre]), np.concatenate([found.drift, off])
    both = both_residuals(residual[:, tree.order], tree.parents)
    return TreeJoints(left, found.used, label, W, np.ascontiguousarray(R), np.ascontiguousarray(t), rest, drifts, both)


def _with_pieces(mine: Floats, pieces: Sequence[Floats], ends: Sequence[EndJoint]) -> Floats:
    """(frame, part, …) what the pieces nearer to the body have in place of their part's, and those beyond after all others."""
    out = np.concatenate([mine, np.stack([piece[:, 1] for piece in pieces], axis=1)], axis=1)
    for piece, end in zip(pieces, ends, strict=True):
        out[:, end.cut.part] = piece[:, 0]
    return out


def _extended_tree(old: PartTree, ends: Sequence[EndJoint]) -> RootedTree:
    """The parts' places, parents and borders."""
    new = np.arange(len(ends))
    return RootedTree(
        np.concatenate([old.tree.order, len(old.tree.order) + new]),
        np.concatenate([old.tree.parents, [end.cut.part for end in ends]]),
        np.concatenate([old.tree.border, len(old.borders.pair) + new]),
    )


def _extended_part_tree(
    body: MovingSurface, old: PartTree, tree: RootedTree, parts: MovingParts, ends: Sequence[EndJoint], off: Floats
) -> PartTree:
    """A border and a joint more for every end, as wide as its ring, and how clear the joints are."""
    met, spans = old.borders, score_spans(len(parts.R), body.takes)
    radius, centre = np.array([end.cut.radius for end in ends]), np.stack([end.cut.centre for end in ends])
    first = len(old.tree.order)
    pair = np.stack([tree.order[tree.parents[first:]], tree.order[first:]], axis=1)
    borders = Borders(
        np.concatenate([met.pair, pair]),
        np.concatenate([met.centre, centre]),
        np.concatenate([met.radius, radius]),
        np.concatenate([met.length, 2.0 * np.pi * radius]),
    )
    joints = Joints(np.concatenate([old.joints.rest, centre]), np.concatenate([old.joints.drift, off]))
    turns = np.einsum("tpxy,tpxz->tpyz", parts.R[:, pair[:, 0]], parts.R[:, pair[:, 1]])
    degrees = np.array([widest_turning_range(turns[:, k], spans) for k in range(len(ends))])
    reach = np.array([np.linalg.norm(body.V[e.cut.own[e.cut.far]] - e.cut.centre, axis=1).mean() for e in ends])
    ratio = 2.0 * reach * np.sin(np.radians(degrees) / 2.0) / np.maximum(off, 1e-6 * reach)
    return PartTree(borders, joints, tree, np.append(old.degrees, degrees), np.append(old.ratio, ratio))
