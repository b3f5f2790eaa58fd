"""Fixed bone lengths, and poses in every frame (2014, Sec. 6.3.2, after Aguiar 2006)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.structure.articulated_fit import Motion, fitted, placed, sums


class Posed(NamedTuple):
    """The articulated body in motion.

    motion         : rest positions, rotations and the root's translation
    positions      : (frame, node, xyz) mesh unit
    leaf_positions : (frame, leaf, xyz) mesh unit
    leaf_rest      : (leaf, xyz) in the reference, mesh unit
    drift          : (node,) root mean square distance to the observed joint, mesh unit
    distance       : (frame, node) that distance, mesh unit, NaN where the joint was not observed
    """

    motion: Motion
    positions: Floats
    leaf_positions: Floats
    leaf_rest: Floats
    drift: Floats
    distance: Floats


class Observed(NamedTuple):
    """What the frames show of joints, parts and leaves.

    joint    : (frame, node, xyz) of each joint, mesh unit, NaN where not observed; the root's is its part's centre
    rotation : (frame, node, 3, 3) of each node's part
    leaf     : (frame, leaf, xyz) mesh unit, NaN where not seen
    """

    joint: Floats
    rotation: Floats
    leaf: Floats


def rotations(V: Floats, x: Floats, vertices: Flags) -> Floats:
    """(frame, 3, 3) rotation of some vertices from the reference to each frame; where fewer than three are seen, as before.

    V        : (vertex, xyz) mesh unit
    x        : (frame, vertex, xyz) mesh unit, NaN where not seen
    vertices : (vertex,) which they are
    """
    R = np.broadcast_to(np.eye(3), (len(x), 3, 3)).copy()
    last = -1
    for t, here in enumerate(x):
        visible = vertices & np.isfinite(here[:, 0])
        if visible.sum() >= 3:
            R[t] = rigid_motion(V[visible], here[visible])[0]
            if last < 0:
                R[:t] = R[t]
            last = t
        elif last >= 0:
            R[t] = R[last]
    return R


def posed(
    V: Floats, x: Floats, node: Ints, parents: Ints, observed: Observed, root: Floats, leaf_node: Ints, surface: float = 1.0
) -> Posed:
    """Fixed lengths: offsets that fit all frames best, then the poses that fit each frame best, in least squares (Sec. 6.3.2).

    Both in turn, under a weight of the surface that falls to the one given: joints alone do not determine the roll of a bone,
    and a fit that begins with them diverges.

    V, x      : (vertex, xyz) in the reference · (frame, vertex, xyz) mesh unit, NaN where not seen
    node      : (vertex,) node that carries it, −1 for none
    parents   : (node,) −1 for the root
    observed  : joints, rotations and leaves
    root      : (xyz) the root's position in the reference
    leaf_node : (leaf,) node on which each leaf's bone hangs
    surface   : weight of all vertices of a node against one joint
    """
    X, R, leaf = observed
    shift = np.nan_to_num(X[:, 0]) - np.einsum("txy,y->tx", R[:, 0], root)
    motion = Motion(_joints_at_rest(R, X, parents, root), R, shift)
    for share in _descending(surface):
        rest = _joints_at_rest(motion.R, X, parents, root)
        leaf_rest = rest[leaf_node] + _leaf_offsets(motion.R, X, leaf, leaf_node)
        motion = _fitted(V, x, node, parents, observed, leaf_node, motion._replace(rest=rest), leaf_rest, share)
    positions = placed(motion, parents)
    distance = np.linalg.norm(positions - X, axis=2)
    drift = np.sqrt(np.nanmean(np.where(np.isfinite(distance).any(axis=0), distance, 0.0) ** 2, axis=0))
    ends = positions[:, leaf_node] + np.einsum("texy,ey->tex", motion.R[:, leaf_node], leaf_rest - rest[leaf_node])
    return Posed(motion, positions, ends, leaf_rest, drift, distance)


def _descending(surface: float) -> list[float]:
    """The weights under which poses are fitted: from a surface that weighs as a joint down to the one given, by tens."""
    steps = max(1, round(-np.log10(surface)))
    return np.geomspace(max(1.0, surface), surface, steps + 1).tolist()


def _joints_at_rest(R: Floats, X: Floats, parents: Ints, root: Floats) -> Floats:
    """(node, xyz) the joints in the reference: the offsets from their parents that fit all frames best."""
    rest = np.zeros((len(parents), 3))
    rest[0] = root
    for j in range(1, len(parents)):
        rest[j] = rest[parents[j]] + _offset(R[:, parents[j]], X[:, j] - X[:, parents[j]])
    return rest


def _leaf_offsets(R: Floats, X: Floats, leaf: Floats, leaf_node: Ints) -> Floats:
    """(leaf, xyz) the offsets of the leaves from their joints, in the reference."""
    return np.array([_offset(R[:, j], leaf[:, e] - X[:, j]) for e, j in enumerate(leaf_node)]).reshape(-1, 3)


def _fitted(
    V: Floats, x: Floats, node: Ints, parents: Ints, observed: Observed, leaf_node: Ints, start: Motion, leaf_rest: Floats,
    surface: float,
) -> Motion:  # fmt: skip
    """The poses that fit joints, leaves and surfaces best, for joints that stay in the reference."""
    carried = np.flatnonzero(node >= 0)
    points = np.concatenate([start.rest, leaf_rest, V[carried]])
    goal = np.concatenate([observed.joint, observed.leaf, x[:, carried]], axis=1)
    follows = np.concatenate([np.maximum(parents, 0), leaf_node, node[carried]])
    share = surface / np.maximum(np.bincount(node[carried], minlength=len(parents)), 1)
    weight = np.concatenate([np.ones(len(start.rest) + len(leaf_rest)), share[node[carried]]])
    tau = np.where(np.isfinite(goal[:, :, 0]), weight, 0.0)
    return fitted(sums(points, np.nan_to_num(goal), np.eye(len(parents))[follows], parents, tau), start, parents)


def _offset(R: Floats, apart: Floats) -> Floats:
    """(xyz) the offset o that fits R o ≈ apart best over the frames in which both were seen, Σ |R o − apart|²."""
    in_both = np.isfinite(apart[:, 0])
    return np.asarray(np.einsum("tyx,ty->tx", R[in_both], apart[in_both]).mean(axis=0) if in_both.any() else np.zeros(3))
