"""The first cut's parts in one tree, before other cuts say where its joints lie."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.kinematic_tree import FirstTreeParams, JointParams, PruningParams
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.structure import first_tree as numerics
from kinetree.tasks.numerics.structure.end_effectors import leaf_vertices
from kinetree.tasks.numerics.structure.given_correspondence import is_given, limited_confidence
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence, JointEvidenceSettings
from kinetree.tasks.numerics.structure.laid_parts import laid_frames
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import Dropped, PruningSettings
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings


@task(among=Sequence, block="kinematic_tree")
def first_tree(
    reference: Reference,
    rigid_parts: RigidParts,
    alignment: Mapping[int, Alignment],
    mesh: Mapping[int, Mesh],
    leaves: Leaves,
    params: FirstTreeParams,
) -> FirstTree:
    """Joins the rigid parts into one tree, with the joints that the frames' surfaces alone show (2014, Sec. 6.3; ours)."""
    frames, body = tuple(alignment), aligned_body(reference, alignment, leaves)
    evidence = FrameEvidence.of(
        body.trust,
        np.stack([a.residual for a in alignment.values()]),
        lambda t: (np.array(mesh[frames[t]].vertices, np.float64), np.array(mesh[frames[t]].faces, np.int64)),
        evidence_settings(params),
    )
    label = np.asarray(rigid_parts.label, dtype=np.int64)
    settings = tree_settings(params)._replace(hidden_bones=params.hidden_bones and body.is_given, end_joints=params.end_joints)
    tree = numerics.first_tree(
        body.surface,
        Cut(body.surface.V, label, rigid_parts.rotation, rigid_parts.translation, rigid_parts.residual),
        body.tips,
        body.confidence,
        None if body.is_given else evidence,
        settings=settings,
    )
    laid = () if body.is_given else laid_frames(len(frames)).tolist()
    return _stored(tree, frames, tuple(frames[t] for t in laid))


class AlignedBody(NamedTuple):
    """The body as it was aligned.

    surface    : the reference in motion
    trust      : (frame, vertex) 0 to 1
    confidence : the same; None where all are certain
    is_given   : whether the frames give the correspondence, see `given_correspondence`
    tips       : (leaf,) vertices at the ends of limbs
    """

    surface: MovingSurface
    trust: Floats
    confidence: Floats | None
    is_given: bool
    tips: Ints


def aligned_body(reference: Reference, alignment: Mapping[int, Alignment], leaves: Leaves) -> AlignedBody:
    """What the numerics take of an aligned sequence."""
    V, F, aligned, at = reference.vertices, reference.faces, list(alignment.values()), leaves.frames.index(reference.frame)
    x, trust = np.stack([a.vertices for a in aligned]), np.stack([a.confidence for a in aligned])
    return AlignedBody(
        MovingSurface(np.array(V), np.asarray(F, np.int64), x, surface_areas(V, F), take_spans(tuple(alignment))),
        trust,
        limited_confidence(trust),
        is_given(trust, np.stack([a.residual for a in aligned])),
        leaf_vertices(V, leaves.positions[:, at], leaves.rows[:, at], leaves.kept),
    )


def evidence_settings(params: JointParams) -> JointEvidenceSettings:
    """What makes a joint evident in the frames."""
    return JointEvidenceSettings(params.clear_motion, params.misfit_ratio, params.misfit_ratio_if_moving)


def tree_settings(params: PruningParams) -> KinematicTreeSettings:
    """How parts become joints."""
    return KinematicTreeSettings(PruningSettings(params.degrees, params.ratio))


SAME = ("place", "ends", "label", "rest", "drift", "residual", "radius")
"""Fields that the artifact and the numerics call the same."""


def _stored(tree: numerics.FirstTree, frames: tuple[int, ...], laid: tuple[int, ...]) -> FirstTree:
    """The artifact of what the numerics give; of frames, and of those that parts are laid on."""
    return FirstTree(
        frames=frames,
        laid=laid,
        parents=tuple(tree.parents.tolist()),
        followed=tree.certain_share is None,
        skin=tree.W,
        rotation=tree.R,
        translation=tree.t,
        certain_share=np.ones(tree.R.shape[:2]) if tree.certain_share is None else tree.certain_share,
        end_positions=tree.end_x,
        **{name: getattr(tree, name) for name in SAME},
        **{**tree.graph._asdict(), "dropped": tuple((d.part, d.reason) for d in tree.graph.dropped)},
    )


def restored(tree: FirstTree) -> numerics.FirstTree:
    """What the numerics take of the artifact."""
    graph = {name: np.array(getattr(tree, name)) for name in numerics.PartGraph._fields if name != "dropped"}
    same = {name: getattr(tree, name) for name in SAME}
    return numerics.FirstTree(
        parents=np.array(tree.parents, np.int64),
        W=np.array(tree.skin),
        R=np.array(tree.rotation),
        t=np.array(tree.translation),
        certain_share=None if tree.followed else np.array(tree.certain_share),
        end_x=np.array(tree.end_positions),
        graph=numerics.PartGraph(**graph, dropped=tuple(Dropped(*d) for d in tree.dropped)),
        **{**same, "label": np.array(tree.label, np.int64)},
    )
