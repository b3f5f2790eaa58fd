"""From the tree of a cut to the finished articulated body: joints, poses, end effectors, names (2014, Sec. 6.3)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.bone_lengths import free_bone_lengths
from kinetree.tasks.numerics.structure.end_effectors import end_effectors
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_names import joint_names
from kinetree.tasks.numerics.structure.joint_partners import RootedParts, joint_partners
from kinetree.tasks.numerics.structure.joint_rotations import widest_turning_range
from kinetree.tasks.numerics.structure.laid_parts import LaidParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.linked_parts import with_rigid_links
from kinetree.tasks.numerics.structure.mirrored_joints import mirrored_joints
from kinetree.tasks.numerics.structure.narrowings import narrowings
from kinetree.tasks.numerics.structure.necks import Tube, necks, tubes
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.posed_tree import joints_and_ends, joints_of_all_cuts, posed_tree, with_spine
from kinetree.tasks.numerics.structure.pruning import Dropped
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.second_ends import second_ends
from kinetree.tasks.numerics.structure.skinning import heaviest
from kinetree.tasks.numerics.structure.still_joints import PosedTree, Still, with_still_joints
from kinetree.tasks.numerics.structure.tree_joints import NOISE

RIGID_WEIGHT = 0.75
"""Skinning weight of one part above which a vertex belongs to it. Not recorded; it changes labels alone."""


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

    part           : (vertex,) part, before any was dropped
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
    surface_offset : (joint,) root mean square distance from where halves of the frames' surfaces alone have it, mesh unit; NaN
                     where they were not asked or do not say, and where it is none
    hinge_offset   : (joint,) the same along its limb, from where halves of the frames' surfaces bend it, mesh unit; NaN also
                     where no straight limb is
    border_radius  : (joint,) of the border at the joint, mesh unit; NaN for the root and ends of bones
    partner        : (joint,) the joint that is its mirror image, see `joint_partners`; −1 where there is none
    end_joints     : joints that the frames' surfaces alone show, see `extended_tree`
    neck_joints    : joints that the shape alone shows, see `necks`
    mirrored_joints : joints that their mirror images alone show, see `mirrored_joints`
    narrowing_joints : joints that narrowings of limbs alone show, see `narrowings`
    """

    part: Ints
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
    surface_offset: Floats
    hinge_offset: Floats
    border_radius: Floats
    partner: Ints
    end_joints: tuple[int, ...] = ()
    neck_joints: tuple[int, ...] = ()
    mirrored_joints: tuple[int, ...] = ()
    narrowing_joints: tuple[int, ...] = ()


def kinematic_tree(
    body: MovingSurface,
    first: FirstTree,
    leaves: Ints,
    confidence: Floats | None = None,
    *,
    further: Sequence[Floats] = (),
    laid: LaidParts | None = None,
    has_links: bool = False,
    has_second_ends: bool = False,
    has_necks: bool = False,
    has_narrowings: bool = False,
    has_mirrored_joints: bool = False,
    up: Floats | None = None,
) -> tuple[KinematicTree, Derivation]:
    """Places the joints of a tree and poses it in every frame; and how that came about.

    body       : as it was aligned
    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    further    : (frame, joint, xyz) of every cut of the body but the tree's own; joints of the tree are then the mean
                 over all cuts that have them
    laid       : parts on the frames' surfaces, where joints are moved to; None moves none
    has_links       : whether bones that their length alone shows are looked for, see `with_rigid_links`; where every vertex was
                      followed
    has_second_ends : whether the last part of a limb also ends where it stands out beside its tip, see `second_ends`
    has_necks       : whether joints are moved to tubes, and joints added that the shape of tubes alone shows, see `necks`
    has_narrowings  : whether both limbs of a pair have a joint beyond a narrowing, see `narrowings`
    has_mirrored_joints : whether a limb has the joints at its end that its mirror image has, see `mirrored_joints`
    up         : (xyz,) unit vector, by which a person is told, whose spine is placed in the trunk, see `spine_joints`; None
                 leaves spines where motion has them
    """
    V = body.V
    if first.shown:
        body = first.with_ends(body)
    joints = joints_of_all_cuts(first, further, body.size)
    if has_links:
        first, joints = with_rigid_links(body, first, joints, NOISE * body.size)
    pairs = limb_pairs(V, body.F, leaves)
    hanging = _heads(body, first, pairs) if has_necks else []
    tree = posed_tree(body, first, confidence, joints, laid, hanging)
    if up is not None:
        tree = with_spine(body, first, tree, end_effectors(V, body.F, tree.label, tree.parents, leaves), confidence, up)
    if found := list(necks(hanging, tree.motion.rest, first.shown)):
        tree = with_still_joints(tree, found, Still.NECK)
    if has_narrowings:
        tree = _with_narrowings(body, tree, pairs)
    if has_mirrored_joints:
        tree = _with_mirrored_joints(body, tree, pairs)
    if has_second_ends:
        leaves = np.concatenate([leaves, second_ends(V, body.F, tree.label, tree.parents, leaves)])
    ends = end_effectors(V, body.F, tree.label, tree.parents, leaves)
    made, order = _assembled(V, tree, ends, score_spans(len(body.x), body.takes))
    partner = joint_partners(body.F, RootedParts(tree.label, tree.parents, tree.radius), pairs)
    return made, _derivation(first, tree, made, order, partner)


def _heads(body: MovingSurface, first: FirstTree, pairs: LimbPairs) -> list[Tube]:
    """The tubes on which last parts of limbs hang; a hand on a wrist, whose joint has a mirror image, is no head."""
    hanging = tubes(body.V, body.F, first.label, first.parents, first.radius)
    partner = joint_partners(body.F, RootedParts(first.label, first.parents, first.radius), pairs)
    return [tube for tube in hanging if partner[tube.part] < 0]


def _with_narrowings(body: MovingSurface, tree: PosedTree, pairs: LimbPairs) -> PosedTree:
    """The tree with the joints at the narrowings of limbs."""
    found = narrowings(body.V, body.F, RootedParts(tree.label, tree.parents, tree.radius), tree.motion.rest, pairs)
    return with_still_joints(tree, found, Still.NARROWING) if found else tree


def _with_mirrored_joints(body: MovingSurface, tree: PosedTree, pairs: LimbPairs) -> PosedTree:
    """The tree with the joints that mirror images of limbs have, one after the other from the trunk outwards."""
    for _ in range(len(tree.parents)):
        parts = RootedParts(tree.label, tree.parents, tree.radius)
        found = mirrored_joints(body.V, body.F, parts, tree.motion.rest, pairs, tree.still != Still.NO)
        if not found:
            break
        tree = with_still_joints(tree, found, Still.MIRRORED)
    return tree


def _assembled(V: Floats, tree: PosedTree, ends: Ints, spans: Ints) -> tuple[KinematicTree, Ints]:
    """Parts and end effectors as one list of joints, named and in the order of their names · (joint,) that order."""
    parents, motion, W, label = tree.parents, tree.motion, tree.W, tree.label
    parts = len(parents)
    part, is_end, above, rest, X = joints_and_ends(V, tree, ends)
    order, names = joint_names(rest, above, is_end)
    place = np.argsort(order)
    turns = np.einsum("tpxy,tpxz->tpyz", motion.R[:, parents], motion.R)
    degrees = np.array([0.0, *(widest_turning_range(turns[:, p], spans) for p in range(1, parts))])
    influence, weight = heaviest(W)
    body = KinematicTree(
        names=names,
        kinds=tuple("leaf" if is_end[j] else "joint" if above[j] >= 0 else "root" for j in order),
        parents=np.where(above[order] >= 0, place[above[order]], -1),
        rest=rest[order],
        positions=X[:, order],
        rotation=motion.R[:, part[order]],
        confidence=tree.confidence[:, part[order]],
        degrees=np.where(is_end | (tree.still != Still.NO)[part], 0.0, degrees[part])[order],
        drift=np.where(is_end, 0.0, tree.drift[part])[order],
        support=tree.support[part[order]],
        label=np.where(W[np.arange(len(V)), label] >= RIGID_WEIGHT, place[label], -1),
        influence=np.where(weight > 0, place[influence], 0),
        weight=weight,
    )
    return body, order


def _derivation(first: FirstTree, tree: PosedTree, body: KinematicTree, order: Ints, partner: Ints) -> Derivation:
    """The graph of all parts, what became of each part, and lengths before they are held.

    order   : (joint,) part in the tree's order, or beyond them an end effector
    partner : (part,) the part whose joint is the mirror image of each one's; −1 where there is none
    """
    parts, joint = len(tree.parents), np.argsort(order)
    is_part, part = order < parts, np.minimum(order, parts - 1)
    R, t = first.R[:, tree.carrier], first.t[:, tree.carrier]
    length = free_bone_lengths(body.rest, body.parents, np.where(is_part, order, -1), R, t)
    return Derivation(
        **first.graph._asdict(),
        joint_of_part=np.where(tree.place < 0, -1, joint[tree.place]),
        free_length=length.mean(axis=0),
        free_deviation=length.std(axis=0),
        spread=np.where(is_part, tree.spread[part], np.nan),
        agreeing=np.where(is_part, tree.agreeing[part], 0),
        joint_residual=np.where(is_part, tree.residual[part], 0.0),
        surface_offset=np.where(is_part, tree.offset[part], np.nan),
        hinge_offset=np.where(is_part, tree.hinge[part], np.nan),
        border_radius=np.where(is_part & (part > 0), tree.radius[part], np.nan),
        partner=np.where(is_part & (partner[part] >= 0), joint[partner[part]], -1),
        end_joints=_joints(joint, np.isin(tree.carrier, first.shown) & (tree.still == Still.NO)),
        neck_joints=_joints(joint, tree.still == Still.NECK),
        mirrored_joints=_joints(joint, tree.still == Still.MIRRORED),
        narrowing_joints=_joints(joint, tree.still == Still.NARROWING),
    )


def _joints(joint: Ints, are_these: Flags) -> tuple[int, ...]:
    """Those of parts, ascending; both (part,)."""
    return tuple(sorted(joint[np.flatnonzero(are_these)].tolist()))
