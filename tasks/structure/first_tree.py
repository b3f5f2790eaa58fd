"""The first cut's parts in one tree, before other cuts say where its joints lie."""

from collections.abc import Mapping

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
from kinetree.tasks.numerics.structure import first_tree as numerics
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence, JointEvidenceSettings
from kinetree.tasks.numerics.structure.pruning import PruningSettings
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.joint_tree import fields_of


@task(among=Sequence, block="kinematic_tree")
def first_tree(
    reference: Reference,
    rigid_parts: RigidParts,
    alignment: Mapping[int, Alignment],
    mesh: Mapping[int, Mesh],
    leaves: Leaves,
    params: FirstTreeParams,
) -> FirstTree:
    """Joins the rigid parts into one tree, with the joints that this cut shows (2014, Sec. 6.3; ours)."""
    frames, body = tuple(alignment), aligned_body(reference, alignment, leaves)
    evidence = FrameEvidence.of(
        body.trust,
        np.stack([a.residual for a in alignment.values()]),
        lambda t: (np.array(mesh[frames[t]].vertices, np.float64), np.array(mesh[frames[t]].faces, np.int64)),
        evidence_settings(params),
    )
    label = np.asarray(rigid_parts.label, dtype=np.int64)
    tree = numerics.first_tree(
        body.surface,
        Cut(body.surface.V, label, rigid_parts.rotation, rigid_parts.translation, rigid_parts.residual),
        body.tips,
        body.confidence,
        None if body.is_given else evidence,
        settings=tree_settings(params)._replace(hidden_bones=params.hidden_bones and body.is_given),
    )
    return FirstTree(frames=frames, **fields_of(tree))


def evidence_settings(params: JointParams) -> JointEvidenceSettings:
    """What makes a joint evident in the frames."""
    return JointEvidenceSettings(params.clear_motion, params.misfit_ratio, params.misfit_ratio_if_moving)


def tree_settings(params: PruningParams) -> KinematicTreeSettings:
    """How parts become joints."""
    return KinematicTreeSettings(PruningSettings(params.degrees, params.ratio))
