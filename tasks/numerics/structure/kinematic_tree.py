"""From rigid parts to the finished articulated body: tree, joints, skin, poses, end effectors, names (2014, Sec. 6.3)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Motion, placed
from kinetree.tasks.numerics.structure.bone_lengths import free_bone_lengths
from kinetree.tasks.numerics.structure.cut_joints import cut_joints, cut_tree
from kinetree.tasks.numerics.structure.end_effectors import end_effectors
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings, confident_share, frame_poses
from kinetree.tasks.numerics.structure.inserted_bones import NO_PART
from kinetree.tasks.numerics.structure.inserted_ends import inserted_ends
from kinetree.tasks.numerics.structure.joint_consensus import JointConsensus, joint_consensus
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.joint_names import joint_names
from kinetree.tasks.numerics.structure.joint_rotations import widest_turning_range
from kinetree.tasks.numerics.structure.part_tree import MovingSurface, PartTree
from kinetree.tasks.numerics.structure.pruning import Dropped
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.second_ends import second_ends
from kinetree.tasks.numerics.structure.skinning import heaviest
from kinetree.tasks.numerics.structure.surface_joints import surface_joints
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings, TreeJoints


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
    spread         : (joint,) root mean square distance of several cuts' joints from their mean, mesh unit; NaN where one cut
                     alone has the joint, and where it is none
    agreeing       : (joint,) cuts that have it; 0 for the root and ends of bones
    joint_residual : (joint,) root mean square of what the motions of its two parts leave unexplained, mesh unit
    end_joints     : joints that the frames' surfaces alone show, see `inserted_ends`
    """

    pair: Ints
    centre: Floats
    border_drift: Floats
    border_degrees: Floats
    joint_of_part: Ints
    dropped: tuple[Dropped, ...]
    free_length: Floats
    free_deviation: Floats
    spread: Floats
    agreeing: Ints
    joint_residual: Floats
    end_joints: tuple[int, ...] = ()


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
    further: Sequence[Cut] = (),
    carried: Sequence[Floats] = (),
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
    further    : other cuts of the same body; its joints are then the mean over all cuts that have them
    carried    : (frame, joint, xyz) of every further cut, as `cut_joints` gives them, where they are known already
    """
    chosen = settings
    V, x = np.array(V, dtype=np.float64), np.array(x, dtype=np.float64)
    body = MovingSurface(V, np.array(F, dtype=np.int64), x, area, takes)
    given = R.shape[1]
    found = cut_tree(body, Cut(V, label, R, t, residual), leaves, confidence, evidence, chosen)
    alike = chosen._replace(hidden_bones=bool((found.left.origin == NO_PART).any()))
    others, before = carried or [cut_joints(body, cut, leaves, confidence, alike) for cut in further], len(found.rest)
    if chosen.end_joints and evidence is not None and confidence is not None:
        body, found = inserted_ends(body, found, confidence, evidence, chosen.noise * body.size)
    agreed = _agreed(found, others, body.size)
    F, x, tree, label, W, R, t = body.F, body.x, found.left.part_tree.tree, found.label, found.W, found.R, found.t
    rest = agreed.rest
    if chosen.surface_joints and evidence is not None and confidence is not None:
        rest = surface_joints(body, found, rest, confidence, evidence.surface)
    off = found.drift if rest is found.rest else found.drift_at(rest)
    poses = frame_poses(V, x, area, label, W, Motion(rest, R, t[:, 0].copy()), tree.parents, confidence, takes=takes)
    share = confident_share(label, area, confidence, len(x), len(tree.order))
    above = np.maximum(tree.parents, 0)
    support = (np.minimum(share, share[:, above]) >= FramePosesSettings().seen).sum(axis=0)
    if chosen.second_ends:
        leaves = np.concatenate([leaves, second_ends(V, F, label, tree.parents, leaves)])
    ends = end_effectors(V, F, label, tree.parents, leaves)
    spans = score_spans(len(x), takes)
    made, order = _assembled(V, label, W, ends, tree.parents, poses.motion, poses.confidence, off, support, spans, chosen)
    return made, _derivation(found, agreed, given, before, made, order)


def _agreed(found: TreeJoints, further: Sequence[Floats], size: float) -> JointConsensus:
    """Joints of the first cut as all cuts place them; the root as it is."""
    count = len(found.rest)
    if not further:
        return JointConsensus(found.rest, np.full(count, np.nan), np.minimum(np.arange(count), 1))
    mean = joint_consensus(found.rest[1:], found.motion, further, size)
    return JointConsensus(
        np.concatenate([found.rest[:1], mean.rest]), np.append(np.nan, mean.spread), np.append(0, mean.agreeing)
    )


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


def _derivation(
    found: TreeJoints, agreed: JointConsensus, given: int, before: int, body: KinematicTree, order: Ints
) -> Derivation:
    """The graph of all parts, what became of each part, and lengths before they are held.

    given  : how many parts there were
    before : how many of the tree's parts are not those beyond end joints
    order  : (joint,) part in the tree's order, or beyond them an end effector
    """
    left, used, parts = found.left, found.used, len(found.rest)
    joint_of_part = np.full(given, -1)
    origin = left.origin[left.part_tree.tree.order]
    joint_of_part[used[origin[origin != NO_PART]]] = np.argsort(order)[:parts][origin != NO_PART]
    length = free_bone_lengths(body.rest, body.parents, np.where(order < parts, order, -1), found.R, found.t)
    is_part, part = order < parts, np.minimum(order, parts - 1)
    return Derivation(
        pair=used[left.before.borders.pair],
        centre=left.before.joints.rest,
        border_drift=left.before.joints.drift,
        border_degrees=_border_degrees(left.before),
        joint_of_part=joint_of_part,
        dropped=tuple(d._replace(part=int(used[d.part])) for d in left.dropped),
        free_length=length.mean(axis=0),
        free_deviation=length.std(axis=0),
        spread=np.where(is_part, agreed.spread[part], np.nan),
        agreeing=np.where(is_part, agreed.agreeing[part], 0),
        joint_residual=np.where(is_part, found.residual[part], 0.0),
        end_joints=tuple(np.argsort(order)[before:parts].tolist()),
    )


def _border_degrees(tree: PartTree) -> Floats:
    """(border,) range of turning across the borders of the tree, NaN across the others."""
    degrees = np.full(len(tree.borders.pair), np.nan)
    degrees[tree.tree.border[1:]] = tree.degrees[1:]
    return degrees
