"""From rigid parts to the finished articulated body: tree, joints, skin, poses, end effectors, names (2014, Sec. 6.3)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Motion, placed
from kinetree.tasks.numerics.structure.bone_lengths import free_bone_lengths
from kinetree.tasks.numerics.structure.centre_lines import towards_centre_lines
from kinetree.tasks.numerics.structure.end_effectors import end_effectors
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings, confident_share, frame_poses
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.joint_names import joint_names
from kinetree.tasks.numerics.structure.joint_rotations import widest_turning_range
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, PartTree
from kinetree.tasks.numerics.structure.pruning import Dropped, Pruned, PruningSettings, pruned
from kinetree.tasks.numerics.structure.root_place import root_amid_limbs
from kinetree.tasks.numerics.structure.rotation_centres import RotationCentresSettings, rotation_centres
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.second_ends import second_ends
from kinetree.tasks.numerics.structure.skinning import heaviest, skinning


class KinematicTreeSettings(NamedTuple):
    """How parts become joints; lengths are shares of the root of the area where nothing else is said."""

    pruning: PruningSettings
    """What a joint must show to stay."""
    noise: float = 0.002
    """Error of a vertex below which its motion says nothing of its skinning weights. Not recorded. Joints move by 0.3 % of
    the height at most when it is halved or doubled."""
    spread: float = 0.35
    """Standard deviation of a joint about where it is expected, in radii of its border. Not recorded; see DESIGN for what
    the expected place was chosen on. Joints move by 2 % of the height at most when it is halved
    or doubled, errors by 0.14 %."""
    frames_alike: float = 3.0
    """Frames that err alike even where neighbours do not: what is wrong in one pose is wrong in the next like it. Not
    recorded. Joints move by 1.3 % of the height at most when it is halved or doubled, errors by 0.06 %."""
    far: float = 0.7
    """Distance from where it is expected, in radii of its border, at which a joint is held twice as firmly. Chosen on
    heads, whose joints run away along the axis by two radii. Joints move by 0.4 % of the height at most when it is halved
    or doubled."""
    residual_share: float = 0.5
    """Share of what a part's motion leaves of single vertices that its motion may err by: noise averages out over a part.
    Not recorded. Joints move by 0.1 % of the height at most when it is halved or doubled."""
    rigid_weight: float = 0.75
    """Skinning weight of one part above which a vertex belongs to it. Not recorded; it changes labels alone."""
    second_ends: bool = False
    """Whether the last part of a limb also ends where it stands out beside its tip, see `second_ends`."""
    root_amid_limbs: bool = False
    """Whether the root lies amid the limbs that hang on it, see `root_place`, and not amid its surface."""


class KinematicTree(NamedTuple):
    """An articulated body: x_j(t) = x_p(t) + R_p(t) (rest_j − rest_p) for every joint j with parent p.

    names, kinds      : (joint,) kinds are root, joint and leaf (the end of a bone); parents come before children
    parents           : (joint,) −1 for the root
    rest              : (joint, xyz) in the reference mesh, mesh unit
    positions         : (frame, joint, xyz) mesh unit
    rotation          : (frame, joint, 3, 3) from the reference, of the part that turns about the joint; a leaf's its parent's
    confidence        : (frame, joint) 0 to 1
    degrees           : (joint,) range of turning against the parent, the widest of all takes, 0 for root and leaves
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


class Derivation(NamedTuple):
    """How the tree came about; parts are numbered as they were given.

    pair           : (border, 2) parts that meet, before any was dropped
    centre         : (border, xyz) the point of the reference that the two turn about best, mesh unit
    border_drift   : (border,) root mean square distance between that point as its two parts carry it, mesh unit
    border_degrees : (border,) range of turning against each other, NaN for borders outside the spanning tree of all parts
    joint_of_part  : (part,) joint about which each part turns, −1 for parts that were dropped or have no vertices
    dropped        : parts that pruning dropped, in that order, and why
    free_length    : (joint,) mean length of each joint's bone as the parts alone carry its ends, mesh unit; 0 for the root
    free_deviation : (joint,) standard deviation of it over the frames, mesh unit
    """

    pair: Ints
    centre: Floats
    border_drift: Floats
    border_degrees: Floats
    joint_of_part: Ints
    dropped: tuple[Dropped, ...]
    free_length: Floats
    free_deviation: Floats


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
    confidence: Floats | None = None,
    evidence: FrameEvidence | None = None,
    *,
    settings: KinematicTreeSettings,
    takes: Sequence[slice] | None = None,
) -> tuple[KinematicTree, Derivation]:
    """Joins the parts in one tree, places its joints and poses it in every frame; and how that came about.

    V, F       : (vertex, xyz) mesh unit · (face, corner)
    x          : (frame, vertex, xyz) mesh unit
    area       : (vertex,) mesh unit²
    label      : (vertex,) rigid part, −1 for none
    R, t       : (frame, part, 3, 3), (frame, part, xyz) from the reference
    residual   : (frame, part) what a part's motion leaves unexplained, mesh unit
    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    evidence   : the frames' surfaces, which must show every joint; None asks for no evidence
    takes      : positions of the frames of each take; None takes all as one
    """
    chosen = settings
    V, x = np.array(V, dtype=np.float64), np.array(x, dtype=np.float64)
    F, label = np.array(F, dtype=np.int64), _filled(V, np.array(label, dtype=np.int64))
    given = R.shape[1]
    used, label, R, t, residual = _used(label, R, t, residual)
    seen = None if confidence is None else confident_share(label, area, confidence, len(x), R.shape[1])
    parts = MovingParts(label, R, t, residual, seen)
    left = pruned(MovingSurface(V, F, x, area, takes), parts, leaves, evidence, settings=chosen.pruning)
    tree = left.part_tree.tree
    label = np.argsort(tree.order)[left.parts.label]
    tau = np.ones(x.shape[:2]) if confidence is None else np.array(confidence, dtype=np.float64)
    R, t = (np.ascontiguousarray(a[:, tree.order]) for a in (left.parts.R, left.parts.t))
    W = skinning(V, F, x, label, R, t, tree.parents, tau, chosen.noise * float(np.sqrt(area.sum())))
    rest, drift = _joints(V, area, label, W, left, chosen)
    poses = frame_poses(V, x, area, label, W, Motion(rest, R, t[:, 0].copy()), tree.parents, confidence, takes=takes)
    share = confident_share(label, area, confidence, len(x), len(tree.order))
    above = np.maximum(tree.parents, 0)
    support = (np.minimum(share, share[:, above]) >= FramePosesSettings().seen).sum(axis=0)
    if chosen.second_ends:
        leaves = np.concatenate([leaves, second_ends(V, F, label, tree.parents, leaves)])
    ends = end_effectors(V, F, label, tree.parents, leaves)
    spans = score_spans(len(x), takes)
    body, order = _assembled(V, label, W, ends, tree.parents, poses.motion, poses.confidence, drift, support, spans, chosen)
    return body, _derivation(left, used, given, body, order, R, t)


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
    spans: Ints,
    chosen: KinematicTreeSettings,
) -> tuple[KinematicTree, Ints]:
    """Parts and end effectors as one list of joints, named and in the order of their names · (joint,) that order."""
    parts = len(parents)
    part = np.concatenate([np.arange(parts), ends[:, 0]])
    rest = np.concatenate([motion.rest, V[ends[:, 1]]])
    above = np.concatenate([parents, ends[:, 0]])
    is_end = np.arange(len(part)) >= parts
    order, names = joint_names(rest, above, is_end)
    place = np.argsort(order)
    X = placed(motion, parents)
    tips = X[:, ends[:, 0]] + np.einsum("texy,ey->tex", motion.R[:, ends[:, 0]], rest[parts:] - motion.rest[ends[:, 0]])
    turns = np.einsum("tpxy,tpxz->tpyz", motion.R[:, parents], motion.R)
    degrees = np.array([0.0, *(widest_turning_range(turns[:, p], spans) for p in range(1, parts))])
    influence, weight = heaviest(W)
    body = KinematicTree(
        names=names,
        kinds=tuple("leaf" if is_end[j] else "joint" if above[j] >= 0 else "root" for j in order),
        parents=np.where(above[order] >= 0, place[above[order]], -1),
        rest=rest[order],
        positions=np.concatenate([X, tips], axis=1)[:, order],
        rotation=motion.R[:, part[order]],
        confidence=confidence[:, part[order]],
        degrees=np.where(is_end, 0.0, degrees[part])[order],
        drift=np.where(is_end, 0.0, drift[part])[order],
        support=support[part[order]],
        label=np.where(W[np.arange(len(V)), label] >= chosen.rigid_weight, place[label], -1),
        influence=np.where(weight > 0, place[influence], 0),
        weight=weight,
    )
    return body, order


def _derivation(left: Pruned, used: Ints, given: int, body: KinematicTree, order: Ints, R: Floats, t: Floats) -> Derivation:
    """The graph of all parts, what became of each part, and lengths before they are held.

    used  : (part,) number of each part as it was given, of so many given
    order : (joint,) part in the tree's order, or beyond them an end effector
    R, t  : (frame, part, 3, 3), (frame, part, xyz) in the tree's order
    """
    parts = R.shape[1]
    joint_of_part = np.full(given, -1)
    joint_of_part[used[left.origin[left.part_tree.tree.order]]] = np.argsort(order)[:parts]
    length = free_bone_lengths(body.rest, body.parents, np.where(order < parts, order, -1), R, t)
    return Derivation(
        pair=used[left.before.borders.pair],
        centre=left.before.joints.rest,
        border_drift=left.before.joints.drift,
        border_degrees=_border_degrees(left.before),
        joint_of_part=joint_of_part,
        dropped=tuple(d._replace(part=int(used[d.part])) for d in left.dropped),
        free_length=length.mean(axis=0),
        free_deviation=length.std(axis=0),
    )


def _border_degrees(tree: PartTree) -> Floats:
    """(border,) range of turning across the borders of the tree, NaN across the others."""
    degrees = np.full(len(tree.borders.pair), np.nan)
    degrees[tree.tree.border[1:]] = tree.degrees[1:]
    return degrees


def _joints(
    V: Floats, area: Floats, label: Ints, W: Floats, left: Pruned, chosen: KinematicTreeSettings
) -> tuple[Floats, Floats]:
    """Joints in the tree's order, expected amid their border or on centre lines, and their drift."""
    parts, tree, met = left.parts, left.part_tree.tree, left.part_tree.borders
    rest, drift = np.empty((len(tree.order), 3)), np.zeros(len(tree.order))
    root = label == 0
    rest[0] = area[root] @ V[root] / area[root].sum()
    rows = tree.border[1:]
    expected = towards_centre_lines(V, area, label, W, tree.parents, met.centre[rows], met.radius[rows])
    pair = np.stack([tree.order[1:], tree.order[tree.parents[1:]]], axis=1)
    residual = chosen.residual_share * parts.residual
    prior = RotationCentresSettings(chosen.spread, chosen.frames_alike, chosen.far)
    joints = rotation_centres(parts.R, parts.t, pair, expected, met.radius[rows], residual, parts.confidence, prior)
    rest[1:], drift[1:] = joints.rest, joints.drift
    if chosen.root_amid_limbs:
        rest[0] = root_amid_limbs(rest, tree.parents, rest[0])
    return rest, drift


def _filled(V: Floats, label: Ints) -> Ints:
    """Vertices without a part have that of the nearest vertex with one."""
    missing = label < 0
    if not missing.any():
        return label
    if missing.all():
        return np.zeros_like(label)
    filled = label.copy()
    filled[missing] = label[~missing][KDTree(V[~missing]).query(V[missing])[1]]
    return filled


def _used(label: Ints, *of_parts: Floats) -> tuple[Ints, Ints, Floats, Floats, Floats]:
    """(part,) the parts that some vertex has · labels and arrays of these parts alone."""
    used, label = np.unique(label, return_inverse=True)
    R, t, residual = (np.ascontiguousarray(a[:, used], dtype=np.float64) for a in of_parts)
    return used, label.astype(np.int64), R, t, residual
