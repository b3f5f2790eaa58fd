"""The tree in every frame: its joints go where all cuts have them, to tubes, to the surfaces, and to where spines lie.

A joint on a tube stays where motion leaves no doubt about it (`CERTAIN`).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Motion, placed
from kinetree.tasks.numerics.structure.centre_lines import towards_centre_lines
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings, confident_share, frame_poses
from kinetree.tasks.numerics.structure.joint_consensus import JointConsensus, joint_consensus
from kinetree.tasks.numerics.structure.laid_parts import LaidParts
from kinetree.tasks.numerics.structure.limb_motion import Motion as LimbMotion
from kinetree.tasks.numerics.structure.necks import Tube, on_tubes
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.shared_joints import shared_joints
from kinetree.tasks.numerics.structure.spine_joints import spine_shifts
from kinetree.tasks.numerics.structure.still_joints import PosedTree, Still
from kinetree.tasks.numerics.structure.surface_joints import SurfaceJoints, surface_joints

CERTAIN = 2.5
"""How many times as much a joint must drift at its place on a tube as where motion has it to stay where it is; what the motions
of its parts leave unexplained counts as drift there. Of 29 joints of recorded and generated people that would be moved three
have more: 2.6, where motion was right, 3.4, where both were, and 3.8, where the shape was. With 5 these three move as well."""


class JointsAndEnds(NamedTuple):
    """The joints of all parts, in their order, and after them the ends of bones.

    part    : (joint,) the part that turns about each joint; of an end, the part that it ends
    is_end  : (joint,)
    parents : (joint,) −1 for the root
    rest    : (joint, xyz) in the reference, mesh unit
    X       : (frame, joint, xyz) mesh unit
    """

    part: Ints
    is_end: Flags
    parents: Ints
    rest: Floats
    X: Floats


def joints_and_ends(V: Floats, tree: PosedTree, ends: Ints) -> JointsAndEnds:
    """The joints of a tree and the ends of its bones (end, 2), see `end_effectors`."""
    parts, motion, hanging = len(tree.parents), tree.motion, ends[:, 0]
    part = np.concatenate([np.arange(parts), hanging])
    rest = np.concatenate([motion.rest, V[ends[:, 1]]])
    X = placed(motion, tree.parents)
    tips = X[:, hanging] + np.einsum("texy,ey->tex", motion.R[:, hanging], rest[parts:] - motion.rest[hanging])
    above = np.concatenate([tree.parents, hanging])
    return JointsAndEnds(part, np.arange(len(part)) >= parts, above, rest, np.concatenate([X, tips], axis=1))


def posed_tree(
    body: MovingSurface, first: FirstTree, confidence: Floats | None, consensus: JointConsensus, laid: LaidParts | None,
    hanging: Sequence[Tube],
) -> PosedTree:  # fmt: skip
    """The tree in every frame; its joints are where all cuts have them, moved to tubes and to the frames' surfaces.

    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    consensus  : the joints of all parts, see `joints_of_all_cuts`
    laid       : parts on the frames' surfaces; None moves no joint there
    hanging    : tubes that joints are moved to
    """
    parts = len(first.parents)
    shared = shared_joints(first, consensus.rest, body.size, body.takes)
    rest, on_tube = _on_tubes(first, hanging, shared.rest)
    on_surface = SurfaceJoints(rest, *np.full((2, parts), np.nan))
    share = confident_share(first.label, body.area, confidence, len(body.x), parts)
    if laid is not None:
        held, lines = shared.is_shared | on_tube, _lines(body, first, rest)
        on_surface = surface_joints(first, laid, rest, share, held=held, takes=body.takes, lines=lines)
    rest = on_surface.rest
    start = Motion(rest, first.R, first.t[:, 0].copy())
    poses = frame_poses(body.V, body.x, body.area, first.label, first.W, start, first.parents, confidence, takes=body.takes)
    return PosedTree(
        parents=first.parents,
        motion=poses.motion,
        label=first.label,
        W=first.W,
        confidence=poses.confidence,
        drift=first.drift if rest is first.rest else first.drift_at(rest),
        support=(np.minimum(share, share[:, np.maximum(first.parents, 0)]) >= FramePosesSettings().seen).sum(axis=0),
        residual=first.residual,
        radius=first.radius,
        offset=on_surface.offset,
        hinge=on_surface.hinge,
        spread=consensus.spread,
        agreeing=consensus.agreeing,
        place=first.place,
        carrier=np.arange(parts),
        still=np.full(parts, Still.NO),
    )


def with_spine(
    body: MovingSurface, first: FirstTree, tree: PosedTree, ends: Ints, confidence: Floats | None, up: Floats
) -> PosedTree:
    """The tree with the joints of a person's spine where spines lie in a trunk, in every frame (`spine_shifts`).

    ends       : (end, 2) last parts and the vertices where they end, see `end_effectors`
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    up         : (xyz,) unit vector
    """
    found = joints_and_ends(body.V, tree, ends)
    of_joint = np.where(found.is_end, 0.0, tree.radius[found.part])
    moving = LimbMotion(found.rest, found.parents, found.X, tree.motion.R[:, found.part], up)
    shift = spine_shifts(body.V, body.F, moving, of_joint)[: len(tree.parents)]
    if not shift.any():
        return tree
    start = tree.motion._replace(rest=tree.motion.rest + shift)
    poses = frame_poses(body.V, body.x, body.area, tree.label, tree.W, start, tree.parents, confidence, takes=body.takes)
    return tree._replace(motion=poses.motion, confidence=poses.confidence, drift=first.drift_at(start.rest))


def _lines(body: MovingSurface, first: FirstTree, rest: Floats) -> Floats:
    """(part, 3, 3) Σ w a aᵀ over the centre lines a near each joint as it is placed, see `ExpectedJoints`; 0 for the root."""
    near = towards_centre_lines(body.V, body.area, first.label, first.W, first.parents, rest[1:], first.radius[1:])
    return np.concatenate([np.zeros((1, 3, 3)), near.lines])


def _on_tubes(first: FirstTree, hanging: Sequence[Tube], joints: Floats) -> tuple[Floats, Flags]:
    """`on_tubes`; joints (part, xyz) stay where they are if motion leaves no doubt about them."""
    rest, stays = on_tubes(hanging, joints, first.shown)
    if rest is joints:
        return joints, stays
    doubt = np.hypot(first.drift_at(joints), first.residual) + np.finfo(float).tiny
    certain = stays & (first.drift_at(rest) > CERTAIN * doubt)
    return np.where(certain[:, None], joints, rest), stays & ~certain


def joints_of_all_cuts(first: FirstTree, further: Sequence[Floats], size: float) -> JointConsensus:
    """(part,) joints of the tree as all cuts place them; the root as it is.

    further : (frame, joint, xyz) of every cut but the tree's own, mesh unit
    size    : root of the area, mesh unit
    """
    count = len(first.rest)
    if not further:
        return JointConsensus(first.rest, np.full(count, np.nan), np.minimum(np.arange(count), 1))
    mean = joint_consensus(first.rest[1:], first.motion, further, size)
    return JointConsensus(
        np.concatenate([first.rest[:1], mean.rest]), np.append(np.nan, mean.spread), np.append(0, mean.agreeing)
    )
