"""From joints, bones and rigid bodies to one tree with fixed lengths, posed in every frame (2014, Sec. 6.3)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.structure.articulated_fit import Motion, fitted, placed, sums
from kinetree.tasks.numerics.structure.spanning_tree import spanning

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


class Hung(NamedTuple):
    """A tree of nodes, each a joint and what turns about it; the first is the root's body, which turns about its own middle.

    joint   : (node,) area of the joint, −1 for the root
    carries : (node,) the body that turns with it; −1 where it is the joint's own area that does
    parents : (node,) −1 for the root; parents come before children
    """

    joint: Ints
    carries: Ints
    parents: Ints


class Fitted(NamedTuple):
    """The articulated body in motion.

    motion    : rest places, rotations and the root's way
    positions : (frame, node, xyz) mesh unit, ends : (frame, leaf, xyz)
    end_rest  : (leaf, xyz) in the reference
    drift     : (node,) root mean square distance to where the joint was seen, mesh unit
    gap       : (frame, node) that distance, NaN where it was not seen
    """

    motion: Motion
    positions: Floats
    ends: Floats
    end_rest: Floats
    drift: Floats
    gap: Floats


def hung(bone: Ints, carrier: Ints, touches: Bools, area: Floats, body_area: Floats) -> Hung:
    """Hangs joints on bodies and bodies on joints, from the largest body outwards.

    bone      : (bone, 2) areas of the joints that are left after redundant bones were removed
    carrier   : (bone,) the body along which each runs, −1 for none
    touches   : (body, area) whether a body is adjacent to a joint's area
    area      : (area,) mesh unit², body_area : (body,)
    """
    count, bodies = len(area), len(body_area)
    links = [(int(j), count + int(b)) for (i, k), b in zip(bone, carrier, strict=True) if b >= 0 for j in (i, k)]
    links += [(int(i), int(k)) for (i, k), b in zip(bone, carrier, strict=True) if b < 0]
    used = len(links)
    links += [(int(j), count + int(b)) for b, j in np.argwhere(touches)]
    pair = np.array(links, np.int64).reshape(-1, 2)
    kept = spanning(pair, (np.arange(len(pair)) >= used).astype(np.float64), count + bodies)
    near: dict[int, list[int]] = {}
    for a, b in pair[kept].tolist():
        near.setdefault(a, []).append(b)
        near.setdefault(b, []).append(a)
    joints = np.flatnonzero(touches.any(axis=0) | np.isin(np.arange(count), bone))
    root = count + int(np.argmax(body_area)) if bodies else int(joints[np.argmax(area[joints])]) if len(joints) else count
    rows: list[tuple[int, int, int]] = [(-1, root - count, -1) if root >= count else (-1, -1, -1)]
    _branches(rows, near, root, count)
    return Hung(*(np.array(column, np.int64) for column in zip(*rows, strict=True)))


def _branches(rows: list[tuple[int, int, int]], near: dict[int, list[int]], root: int, count: int) -> None:
    """Appends a node for every body beyond a joint, and for every joint beyond which there is none."""
    waiting, seen = [(root, 0)], {root}
    for thing, node in waiting:
        for joint in sorted(j for j in near.get(thing, []) if j not in seen and j < count):
            seen.add(joint)
            beyond = sorted(b for b in near.get(joint, []) if b not in seen)
            on = [b for b in beyond if b >= count]
            for b in on:
                seen.add(b)
                rows.append((joint, b - count, node))
                waiting.append((b, len(rows) - 1))
            if len(on) < len(beyond) or not on:
                rows.append((joint, -1, node))
                waiting.append((joint, len(rows) - 1))


def rotations(V: Floats, y: Floats, mine: Bools) -> Floats:
    """(frame, 3, 3) rotation of some vertices from the reference to each frame; where fewer than three are seen, as before.

    V : (vertex, xyz), y : (frame, vertex, xyz) mesh unit, NaN where not seen
    """
    R = np.broadcast_to(np.eye(3), (len(y), 3, 3)).copy()
    known = -1
    for t, at in enumerate(y):
        here = mine & np.isfinite(at[:, 0])
        if here.sum() >= 3:
            R[t] = rigid_motion(V[here], at[here])[0]
            if known < 0:
                R[:t] = R[t]
            known = t
        elif known >= 0:
            R[t] = R[known]
    return R


def posed(
    V: Floats,
    y: Floats,
    of: Ints,
    tree: Hung,
    X: Floats,
    R: Floats,
    middle: Floats,
    on: Ints,
    tips: Floats,
    surface: float = 1.0,
) -> Fitted:
    """Fixed lengths: offsets that fit all frames best, then the poses that fit each frame best, in least squares (Sec. 6.3.2).

    V, y    : (vertex, xyz) in the reference, (frame, vertex, xyz) mesh unit, NaN where not seen
    of      : (vertex,) node that carries it, −1 for none
    X       : (frame, node, xyz) where each joint was seen, NaN where it was not; the root's is the middle of its body
    R       : (frame, node, 3, 3) of what each node carries
    middle  : (xyz) the root's place in the reference
    surface : weight of a node's surface against one joint
    on      : (leaf,) node, tips : (frame, leaf, xyz) where the leaves were seen
    """
    parents = tree.parents
    rest = np.zeros((len(parents), 3))
    rest[0] = middle
    for j in range(1, len(parents)):
        rest[j] = rest[parents[j]] + _offset(R[:, parents[j]], X[:, j] - X[:, parents[j]])
    ends = rest[on] + np.array([_offset(R[:, j], tips[:, e] - X[:, j]) for e, j in enumerate(on)]).reshape(-1, 3)
    held = np.flatnonzero(of >= 0)
    points = np.concatenate([rest, ends, V[held]])
    seen = np.concatenate([X, tips, y[:, held]], axis=1)
    follows = np.concatenate([np.maximum(parents, 0), on, of[held]])
    share = surface / np.maximum(np.bincount(of[held], minlength=len(parents)), 1)
    tau = np.where(np.isfinite(seen[:, :, 0]), np.concatenate([np.ones(len(rest) + len(ends)), share[of[held]]]), 0.0)
    W = np.eye(len(parents))[follows]
    start = Motion(rest, R, np.nan_to_num(X[:, 0]) - np.einsum("txy,y->tx", R[:, 0], middle))
    found = fitted(sums(points, np.nan_to_num(seen), W, parents, tau), start, parents)
    places = placed(found, parents)
    gap = np.linalg.norm(places - X, axis=2)
    drift = np.sqrt(np.nanmean(np.where(np.isfinite(gap).any(axis=0), gap, 0.0) ** 2, axis=0))
    moved = places[:, on] + np.einsum("texy,ey->tex", found.R[:, on], ends - rest[on])
    return Fitted(found, places, moved, ends, drift, gap)


def _offset(R: Floats, apart: Floats) -> Floats:
    """(xyz) the offset o that fits R o ≈ apart best over the frames in which both were seen, Σ |R o − apart|²."""
    seen = np.isfinite(apart[:, 0])
    return np.asarray(np.einsum("tyx,ty->tx", R[seen], apart[seen]).mean(axis=0) if seen.any() else np.zeros(3))
