"""How far off every joint is expected to be."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.structure.error_bars import ErrorBars, EvidenceKind
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.structure import error_bars as numerics
from kinetree.tasks.numerics.structure.joint_partners import bone_asymmetry
from kinetree.tasks.numerics.structure.skin_softness import skin_softness
from kinetree.tasks.numerics.structure.turning_resistance import turning_resistance


@task()
def error_bars(skeleton: Skeleton, kinematic_tree: KinematicTree) -> ErrorBars:
    """Expects an error of every joint, from how it moves, where cuts and surfaces have it, and its parts' shape (ours)."""
    features = joint_features(skeleton, kinematic_tree)
    found = numerics.error_bars(features, kinematic_tree.cuts)
    turning = np.array([kind == "joint" for kind in skeleton.kinds])

    def of_joints(values: Floats) -> Floats:
        return np.where(turning, values, np.nan)

    return ErrorBars(
        joints=skeleton.names,
        frames=skeleton.frames,
        cuts=kinematic_tree.cuts,
        expected=of_joints(found.expected),
        bound=of_joints(found.bound),
        in_frame=of_joints(found.in_frame),
        drift=of_joints(features.drift),
        spread=of_joints(features.spread),
        residual=of_joints(features.residual),
        surface_offset=of_joints(features.offset),
        turning_resistance=of_joints(features.resistance),
        hinge_offset=of_joints(features.hinge),
        turning_below=of_joints(features.below),
        softness=of_joints(features.softness),
        asymmetry=of_joints(features.asymmetry),
        agreeing=kinematic_tree.agreeing,
        support=np.where(turning, skeleton.support, 0),
        evidence=_evidence(skeleton, kinematic_tree),
    )


@task()
def unknown_error_bars(skeleton: Skeleton) -> ErrorBars:
    """Says that no error is known: the constants of `error_bars` were fitted to another method (ours)."""
    return nothing_known(skeleton)


def nothing_known(skeleton: Skeleton) -> ErrorBars:
    """Error bars without any."""
    joints = len(skeleton.names)
    unknown, none = np.full(joints, np.nan), np.zeros(joints, np.int32)
    return ErrorBars(
        joints=skeleton.names, frames=skeleton.frames, cuts=0, expected=unknown, bound=unknown,
        in_frame=np.full((len(skeleton.frames), joints), np.nan), drift=unknown, spread=unknown, residual=unknown,
        surface_offset=unknown, turning_resistance=unknown, hinge_offset=unknown, turning_below=unknown, softness=unknown,
        asymmetry=unknown, agreeing=none, support=none, evidence=(None,) * joints,
    )  # fmt: skip


def joint_features(skeleton: Skeleton, kinematic_tree: KinematicTree) -> numerics.JointFeatures:
    """What is known of all joints, root and leaves among them."""
    tree = kinematic_tree
    V, F, label = np.array(skeleton.vertices), np.array(skeleton.faces, np.int64), np.array(skeleton.label, np.int64)
    rest, parents, area = np.array(skeleton.rest), np.array(skeleton.parents), surface_areas(V, F)
    resistance, size = turning_resistance(V, F, label, parents, rest), float(np.sqrt(area.sum()))
    softness = skin_softness(V, area, np.array(skeleton.weight), rest)
    of_joints = (skeleton.drift, tree.spread, tree.joint_residual, skeleton.degrees, skeleton.lengths, tree.surface_offset)
    drift, spread, residual, degrees, length, offset = (np.array(a) for a in of_joints)
    radius = np.where(tree.is_given, np.array(tree.border_radius), np.nan)
    joints = np.arange(len(skeleton.names))
    tube, narrowing, mirrored = (
        np.where(np.isin(joints, some), np.array(tree.border_radius), np.nan)
        for some in (tree.neck_joints, tree.narrowing_joints, tree.mirrored_joints)
    )
    confidence = np.array(skeleton.confidence)
    below = np.zeros_like(degrees)
    np.maximum.at(below, parents[parents >= 0], degrees[parents >= 0])
    return numerics.JointFeatures(
        drift, spread, residual, degrees, length, offset, resistance, np.array(tree.hinge_offset), below, softness,
        radius, np.isin(joints, tree.end_joints), tube, narrowing, mirrored, _asymmetry(skeleton, tree), confidence, size,
    )  # fmt: skip


def _asymmetry(skeleton: Skeleton, kinematic_tree: KinematicTree) -> Floats:
    """(joint,) difference between the lengths of a joint's bone and of that bone's mirror image, mesh unit; NaN where it has
    none, and where one of both joints is placed by the other.
    """
    partner = np.array(kinematic_tree.partner, np.int64)
    is_placed = np.isin(np.arange(len(partner)), kinematic_tree.mirrored_joints)
    unlike = bone_asymmetry(np.array(skeleton.parents, np.int64), partner, np.array(skeleton.lengths))
    return np.where(is_placed | is_placed[partner], np.nan, unlike)


def _evidence(skeleton: Skeleton, kinematic_tree: KinematicTree) -> tuple[EvidenceKind | None, ...]:
    """How each joint is known; None for root and leaves."""
    known: list[EvidenceKind | None] = ["motion" if kind == "joint" else None for kind in skeleton.kinds]
    still: tuple[tuple[EvidenceKind, tuple[int, ...]], ...] = (
        ("shape", kinematic_tree.neck_joints),
        ("narrowing", kinematic_tree.narrowing_joints),
        ("mirror", kinematic_tree.mirrored_joints),
    )
    for kind, joints in still:
        for j in joints:
            known[j] = kind
    return tuple(known)
