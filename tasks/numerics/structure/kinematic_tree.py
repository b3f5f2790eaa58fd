"""From rigid parts to the finished articulated body: tree, joints, skin, poses, ends of bones, names (2014, Sec. 6.3)."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Motion, placed
from kinetree.tasks.numerics.structure.centre_lines import towards_axes
from kinetree.tasks.numerics.structure.end_effectors import bone_ends
from kinetree.tasks.numerics.structure.frame_poses import SEEN, posed, seen_share
from kinetree.tasks.numerics.structure.joint_evidence import Seen
from kinetree.tasks.numerics.structure.joint_names import named
from kinetree.tasks.numerics.structure.joint_rotations import turning_range
from kinetree.tasks.numerics.structure.part_tree import Carried, Surfaces
from kinetree.tasks.numerics.structure.pruning import LEAST_DEGREES, LEAST_RATIO, Pruned, pruned
from kinetree.tasks.numerics.structure.rotation_centres import rotation_centres
from kinetree.tasks.numerics.structure.skinning import heaviest, skinning

NOISE = 0.002
"""Error of a vertex below which its motion says nothing of its weights, share of the root of the area."""
SPREAD = 0.35
"""Standard deviation of a joint about where it is expected, in radii of its border."""
ALIKE = 3.0
"""Frames that err alike even where neighbours do not: what is wrong in one pose is wrong in the next like it."""
FAR = 0.7
"""Distance from where it is expected, in radii of its border, at which a joint is held twice as firmly."""
QUIET = 0.5
"""Share of what a part's motion leaves of single vertices that its motion may err by: noise averages out over a part."""
RIGID = 0.75
"""Weight of one part above which a vertex belongs to it."""


class KinematicTree(NamedTuple):
    """An articulated body: x_j(t) = x_p(t) + R_p(t) (rest_j − rest_p) for every joint j with parent p.

    names, kinds      : (joint,) kinds are root, joint and leaf (the end of a bone); a parent before what hangs on it
    parents           : (joint,) −1 for the root
    rest              : (joint, xyz) in the reference mesh, mesh unit
    positions         : (frame, joint, xyz) mesh unit
    rotation          : (frame, joint, 3, 3) from the reference, of the part that turns about the joint; a leaf's its parent's
    confidence        : (frame, joint) 0 to 1
    degrees           : (joint,) range of turning against the parent, 0 for root and leaves
    drift             : (joint,) distance between the joint as its two parts alone would carry it, mesh unit
    support           : (joint,) frames in which its parts were seen
    label             : (vertex,) joint whose rigid part a vertex belongs to, −1 where the surface is not rigid
    influence, weight : (vertex, 4) joints a vertex follows, heaviest first, and how much
    """

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    parents: Ints
    rest: Floats
    positions: Floats
    rotation: Floats
    confidence: Floats
    degrees: Floats
    drift: Floats
    support: Ints
    label: Ints
    influence: Ints
    weight: Floats


def kinematic_tree(
    V: Floats,
    F: Ints,
    x: Floats,
    area: Floats,
    label: Ints,
    R: Floats,
    t: Floats,
    residual: Floats,
    leaves: Ints,
    trust: Floats | None = None,
    surfaces: Seen | None = None,
    *,
    degrees: float = LEAST_DEGREES,
    ratio: float = LEAST_RATIO,
) -> KinematicTree:
    """The whole of it.

    V, F     : (vertex, xyz) mesh unit · (face, corner)
    x        : (frame, vertex, xyz) mesh unit
    area     : (vertex,) mesh unit²
    label    : (vertex,) rigid part, −1 for none
    R, t     : (frame, part, 3, 3), (frame, part, xyz) from the reference
    residual : (frame, part) what a part's motion leaves unexplained, mesh unit
    leaves   : (leaf,) vertices at the ends of limbs
    trust    : (frame, vertex) 0 to 1; None believes all
    surfaces : the frames' surfaces, by which joints are shown; None asks none
    degrees, ratio : what a joint must turn by, and how many times farther than it drifts
    """
    V, x = np.array(V, dtype=np.float64), np.array(x, dtype=np.float64)
    F, label = np.array(F, dtype=np.int64), _filled(V, np.array(label, dtype=np.int64))
    label, R, t, residual = _used(label, R, t, residual)
    seen = None if trust is None else seen_share(label, area, trust, len(x), R.shape[1])
    parts = Carried(label, R, t, residual, seen)
    found = pruned(Surfaces(V, F, x, area), parts, leaves, surfaces, degrees=degrees, ratio=ratio)
    tree = found.part_tree.tree
    label = np.argsort(tree.order)[found.parts.label]
    tau = np.ones(x.shape[:2]) if trust is None else np.array(trust, dtype=np.float64)
    R, t = (np.ascontiguousarray(a[:, tree.order]) for a in (found.parts.R, found.parts.t))
    W = skinning(V, F, x, label, R, t, tree.parents, tau, NOISE * float(np.sqrt(area.sum())))
    rest, drift = _settled(V, area, label, W, found)
    body = posed(V, x, area, label, W, Motion(rest, R, t[:, 0].copy()), tree.parents, trust)
    shown = seen_share(label, area, trust, len(x), len(tree.order))
    above = np.maximum(tree.parents, 0)
    support = (np.minimum(shown, shown[:, above]) >= SEEN).sum(axis=0)
    return _assembled(V, label, W, bone_ends(V, F, label, tree.parents, leaves), tree.parents, body.motion, body.confidence,
                      drift, support)  # fmt: skip


def _assembled(
    V: Floats,
    label: Ints,
    W: Floats,
    ends: Ints,
    parents: Ints,
    motion: Motion,
    confidence: Floats,
    drift: Floats,
    support: Ints,
) -> KinematicTree:
    """Parts and ends of bones as one list of joints, named and in the order of their names."""
    parts = len(parents)
    of = np.concatenate([np.arange(parts), ends[:, 0]])
    rest = np.concatenate([motion.rest, V[ends[:, 1]]])
    above = np.concatenate([parents, ends[:, 0]])
    is_end = np.arange(len(of)) >= parts
    order, names = named(rest, above, is_end)
    place = np.argsort(order)
    X = placed(motion, parents)
    tips = X[:, ends[:, 0]] + np.einsum("texy,ey->tex", motion.R[:, ends[:, 0]], rest[parts:] - motion.rest[ends[:, 0]])
    turns = np.einsum("tpxy,tpxz->tpyz", motion.R[:, parents], motion.R)
    degrees = np.array([0.0, *(turning_range(turns[:, p]) for p in range(1, parts))])
    influence, weight = heaviest(W)
    follows = np.where(weight > 0, place[influence], 0)
    return KinematicTree(
        names=names,
        kinds=tuple("leaf" if is_end[j] else "joint" if above[j] >= 0 else "root" for j in order),
        parents=np.where(above[order] >= 0, place[above[order]], -1),
        rest=rest[order],
        positions=np.concatenate([X, tips], axis=1)[:, order],
        rotation=motion.R[:, of[order]],
        confidence=confidence[:, of[order]],
        degrees=np.where(is_end, 0.0, degrees[of])[order],
        drift=np.where(is_end, 0.0, drift[of])[order],
        support=support[of[order]],
        label=np.where(W[np.arange(len(V)), label] >= RIGID, place[label], -1),
        influence=follows,
        weight=weight,
    )


def _settled(V: Floats, area: Floats, label: Ints, W: Floats, found: Pruned) -> tuple[Floats, Floats]:
    """Joints in the tree's order, expected amid border or on centre lines, and their drift; the root's is its middle."""
    parts, tree, met = found.parts, found.part_tree.tree, found.part_tree.borders
    rest, drift = np.empty((len(tree.order), 3)), np.zeros(len(tree.order))
    root = label == 0
    rest[0] = area[root] @ V[root] / area[root].sum()
    rows = tree.border[1:]
    expected = towards_axes(V, area, label, W, tree.parents, met.centre[rows], met.radius[rows])
    pair = np.stack([tree.order[1:], tree.order[tree.parents[1:]]], axis=1)
    held = (expected, met.radius[rows], QUIET * parts.residual, parts.trust)
    joints = rotation_centres(parts.R, parts.t, pair, *held, spread=SPREAD, alike=ALIKE, far=FAR)
    rest[1:], drift[1:] = joints.rest, joints.drift
    return rest, drift


def _filled(V: Floats, label: Ints) -> Ints:
    """Vertices without a part have that of the nearest vertex with one."""
    bare = label < 0
    if not bare.any():
        return label
    if bare.all():
        return np.zeros_like(label)
    filled = label.copy()
    filled[bare] = label[~bare][KDTree(V[~bare]).query(V[bare])[1]]
    return filled


def _used(label: Ints, *of_parts: Floats) -> tuple[Ints, Floats, Floats, Floats]:
    """The same without parts that no vertex has."""
    used, label = np.unique(label, return_inverse=True)
    R, t, residual = (np.ascontiguousarray(a[:, used], dtype=np.float64) for a in of_parts)
    return label.astype(np.int64), R, t, residual
