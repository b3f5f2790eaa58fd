"""The articulated body: joints where all cuts have them, a pose for every frame, and the skin that follows."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.extended_tree import ExtendedTree
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import KinematicTree, KinematicTreeParams, NeckParams
from kinetree.schemas.structure.laid_parts import LaidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure import kinematic_tree as numerics
from kinetree.tasks.numerics.structure.agreeing_cut import CutJoints, agreeing_cut, first_cut
from kinetree.tasks.numerics.structure.pose_refinement import needs_refinement
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.arguments.laid_parts import joined


@task(among=Sequence, block=KinematicTreeParams)
def kinematic_tree(
    reference: Reference,
    extended_tree: ExtendedTree,
    further_cut: Mapping[int, FurtherCut],
    laid_parts: tuple[LaidParts, ...],
    alignment: Mapping[int, Alignment],
    leaves: Leaves,
    params: NeckParams,
) -> KinematicTree:
    """Places the joints of the tree where all cuts have them, and poses it in every frame (2014, Sec. 6.3)."""
    frames, body, first = tuple(alignment), aligned_body(reference, alignment, leaves), restored(extended_tree)
    cuts = list(further_cut.values())
    joints = [CutJoints(np.array(cut.bare_joints), np.array(cut.joints_with_bones)) for cut in cuts]
    if body.is_given:
        chosen = agreeing_cut(first, [restored(cut) for cut in cuts], joints, body.surface.size)
    else:
        chosen = first_cut(first, joints)
    tree, derivation = numerics.kinematic_tree(
        body.surface,
        chosen.tree,
        body.tips,
        body.confidence,
        further=chosen.further,
        laid=joined(laid_parts),
        has_necks=params.necks and not body.is_given,
    )
    return KinematicTree(
        frames=frames,
        vertices=reference.vertices,
        faces=reference.faces,
        cuts=1 + len(further_cut),
        cut_frame=cuts[chosen.which - 1].frame if chosen.which else None,
        is_given=body.is_given,
        uncertain=np.zeros(len(frames), np.bool_) if body.is_given else needs_refinement(tree.confidence),
        **{**tree._asdict(), "parents": tuple(tree.parents.tolist())},
        **{**derivation._asdict(), "dropped": tuple((d.part, d.reason) for d in derivation.dropped)},
    )
