"""The finished articulated body of the 2014 paper: rotations, fixed lengths, leaf bones, names (Sec. 6.3)."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.paper_2014.assembly import Fitted, Hung, posed, rotations
from kinetree.tasks.numerics.structure.joint_names import joint_names
from kinetree.tasks.numerics.structure.joint_rotations import turning_range
from kinetree.tasks.numerics.structure.kinematic_tree import KinematicTree

HALF = 0.04
"""At this distance between a joint and where it was seen it is half believed, share of the root of the area."""

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def kinematic_structure(
    V: Floats,
    area: Floats,
    y: Floats,
    label: Ints,
    body: Ints,
    tree: Hung,
    centroid: Floats,
    tip: Ints,
    tips: Floats,
    surface: float = 1.0,
) -> KinematicTree:
    """The whole of it.

    V, area  : (vertex, xyz) mesh unit, (vertex,) mesh unit²
    y        : (frame, vertex, xyz) mesh unit, NaN where not seen
    label    : (vertex,) area, body : (area,) rigid body, −1 for joints
    centroid : (frame, area, xyz) mesh unit, NaN where not seen
    tip      : (leaf,) vertices, tips : (frame, leaf, xyz) where they are, NaN where not seen
    surface  : weight of a body's surface against one joint
    """
    of, own = _carriers(label, body, tree), _own(label, body, tree)
    R = np.stack([rotations(V, y, mine) for mine in own], axis=1)
    weight = area * own[0]
    X = np.concatenate([np.full((len(y), 1, 3), np.nan), centroid[:, tree.joint[1:]]], axis=1)
    X[:, 0] = _middle(weight, y)
    on = _bearers(V, tip, of, label, tree)
    middle = weight @ V / weight.sum()
    found = posed(V, y, of, tree, X, R, middle, on, tips, surface)
    return _named(V, label, body, of, tree, X, tips, on, found, HALF * float(np.sqrt(area.sum())))


def _own(label: Ints, body: Ints, tree: Hung) -> list[npt.NDArray[np.bool_]]:
    """Of each node, the vertices of the body that it carries, else of the joint's own area; all if it is nothing's."""
    of_body = body[label] if len(body) else np.zeros_like(label)
    own = [of_body == b if b >= 0 else label == j for j, b in zip(tree.joint, tree.carries, strict=True)]
    return [mine if mine.any() else np.ones(len(label), dtype=bool) for mine in own]


def _carriers(label: Ints, body: Ints, tree: Hung) -> Ints:
    """(vertex,) node whose rotation a vertex has, −1 for a joint beyond which there is a body."""
    of = np.full(len(label), -1)
    for node, mine in enumerate(_own(label, body, tree)):
        of[mine & (of < 0)] = node
    return of


def _middle(weight: Floats, y: Floats) -> Floats:
    """(frame, xyz) middle of what is seen; NaN where nothing is."""
    seen = weight * np.isfinite(y[:, :, 0])
    total = seen.sum(axis=1)[:, None]
    place = np.einsum("tv,tvx->tx", seen, np.nan_to_num(y))
    return np.asarray(np.where(total > 0.0, place / np.maximum(total, 1e-300), np.nan), dtype=np.float64)


def _bearers(V: Floats, tip: Ints, of: Ints, label: Ints, tree: Hung) -> Ints:
    """(leaf,) the node on which each leaf's bone hangs: that which carries it, else that of the joint it lies in."""
    on = of[tip].copy()
    for e in np.flatnonzero(on < 0):
        mine = np.flatnonzero(tree.joint == label[tip[e]])
        on[e] = mine[0] if len(mine) else 0
    return on


def _named(
    V: Floats, label: Ints, body: Ints, of: Ints, tree: Hung, X: Floats, tips: Floats, on: Ints, found: Fitted, half: float
) -> KinematicTree:
    """Nodes and leaves as one list of joints, named and in the order of their names.

    A joint is believed as far as it is where it was seen, 1 / (1 + (gap / half)²), and not at all where it was not.
    """
    nodes, frames = len(tree.parents), len(X)
    carrying = np.concatenate([np.arange(nodes), on])
    above = np.concatenate([tree.parents, on])
    rest = np.concatenate([found.motion.rest, found.end_rest])
    is_end = np.arange(len(above)) >= nodes
    order, names = joint_names(rest, above, is_end)
    place = np.argsort(order)
    R = found.motion.R
    turns = np.einsum("tpxy,tpxz->tpyz", R[:, np.maximum(tree.parents, 0)], R)
    degrees = np.array([0.0, *(turning_range(turns[:, p]) for p in range(1, nodes)), *np.zeros(len(on))])
    seen = np.isfinite(np.concatenate([X, tips], axis=1)[:, :, 0])
    gap = np.nan_to_num(np.concatenate([found.gap, np.linalg.norm(found.ends - tips, axis=2)], axis=1))
    influence, weight = _skin(label, of, tree)
    rigid = body[label] >= 0 if len(body) else np.ones(len(V), dtype=bool)
    return KinematicTree(
        names=names,
        kinds=tuple("leaf" if is_end[j] else "joint" if above[j] >= 0 else "root" for j in order),
        parents=np.where(above[order] >= 0, place[above[order]], -1),
        rest=rest[order],
        positions=np.concatenate([found.positions, found.ends], axis=1)[:, order],
        rotation=R[:, carrying[order]],
        confidence=(seen / (1.0 + (gap / half) ** 2))[:, order].reshape(frames, -1),
        degrees=degrees[order],
        drift=np.concatenate([found.drift, np.zeros(len(on))])[order],
        support=seen.sum(axis=0)[order],
        label=np.where(rigid & (of >= 0), place[of], -1),
        influence=np.where(weight > 0, place[influence], 0),
        weight=weight,
    )


def _skin(label: Ints, of: Ints, tree: Hung) -> tuple[Ints, Floats]:
    """(vertex, 4) nodes and weights: rigid areas follow their node, joints half of what they join."""
    influence, weight = np.zeros((len(label), 4), np.int64), np.zeros((len(label), 4))
    influence[:, 0], weight[:, 0] = np.maximum(of, 0), 1.0
    for joint in np.unique(label[of < 0]):
        nodes = np.flatnonzero(tree.joint == joint)
        both = np.unique([*tree.parents[nodes], *nodes])[:4]
        mine = (label == joint) & (of < 0)
        if len(both):
            influence[mine, : len(both)], weight[mine, : len(both)] = both, 1.0 / len(both)
    return influence, weight
