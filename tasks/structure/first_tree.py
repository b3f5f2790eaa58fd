"""The first cut's parts in one tree, before other cuts say where its joints lie."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.kinematic_tree import FirstTreeParams, PruningParams
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure import first_tree as numerics
from kinetree.tasks.numerics.structure.pruning import PruningSettings
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.frame_evidence import frame_evidence
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
    body = aligned_body(reference, alignment, leaves)
    label = np.asarray(rigid_parts.label, dtype=np.int64)
    tree = numerics.first_tree(
        body.surface,
        Cut(body.surface.V, label, rigid_parts.rotation, rigid_parts.translation, rigid_parts.residual),
        body.tips,
        body.confidence,
        frame_evidence(body, alignment, mesh, params),
        settings=tree_settings(params)._replace(hidden_bones=params.hidden_bones and body.is_given),
    )
    return FirstTree(frames=tuple(alignment), **fields_of(tree))


def tree_settings(params: PruningParams) -> KinematicTreeSettings:
    """How parts become joints."""
    return KinematicTreeSettings(PruningSettings(params.degrees, params.ratio))
