"""The articulated body: joints where all cuts have them, a pose for every frame, and the skin that follows."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.extended_tree import ExtendedTree
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import KinematicTree, KinematicTreeParams, PlacedTreeParams
from kinetree.schemas.structure.laid_parts import LaidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure import kinematic_tree as numerics
from kinetree.tasks.numerics.structure.first_tree import FirstTree as Tree
from kinetree.tasks.numerics.structure.pose_refinement import needs_refinement
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.arguments.laid_parts import joined
from kinetree.tasks.structure.arguments.signed_axis import signed_axis


@task(among=Sequence, block=KinematicTreeParams)
def kinematic_tree(
    reference: Reference,
    extended_tree: ExtendedTree,
    first_tree: FirstTree,
    further_cut: Mapping[int, FurtherCut],
    laid_parts: tuple[LaidParts, ...],
    alignment: Mapping[int, Alignment],
    leaves: Leaves,
    up_direction: UpDirection,
    params: PlacedTreeParams,
) -> KinematicTree:
    """Places the joints of the tree where all cuts have them, and poses it in every frame (2014, Sec. 6.3)."""
    frames, body, agreed = tuple(alignment), aligned_body(reference, alignment, leaves), restored(extended_tree)
    tree, derivation = numerics.kinematic_tree(
        body.surface,
        agreed,
        body.tips,
        body.confidence,
        further=[
            _joints_of_first(first_tree) if frame == extended_tree.cut_frame else _joints_beside(agreed, cut)
            for frame, cut in further_cut.items()
        ],
        laid=joined(laid_parts),
        has_links=params.hidden_bones and body.is_given,
        has_necks=params.necks,
        has_narrowings=params.narrowings and not body.is_given,
        has_mirrored_joints=params.mirrored_joints and not body.is_given,
        up=signed_axis(up_direction.up) if params.spine and not body.is_given else None,
    )
    return KinematicTree(
        frames=frames,
        vertices=reference.vertices,
        faces=reference.faces,
        cuts=1 + len(further_cut),
        cut_frame=extended_tree.cut_frame,
        is_given=body.is_given,
        uncertain=np.zeros(len(frames), np.bool_) if body.is_given else needs_refinement(tree.confidence),
        **{**tree._asdict(), "parents": tuple(tree.parents.tolist())},
        **{**derivation._asdict(), "dropped": tuple((d.part, d.reason) for d in derivation.dropped)},
    )


def _joints_of_first(first_tree: FirstTree) -> Floats:
    """(frame, joint, xyz) mesh unit, where another cut gives the tree."""
    tree = restored(first_tree)
    return tree.motion.carried(tree.rest[1:])


def _joints_beside(tree: Tree, cut: FurtherCut) -> Floats:
    """(frame, joint, xyz) of another cut, mesh unit; with bones that no cut can find if the tree has some."""
    return np.array(cut.joints_with_bones if tree.has_bones else cut.bare_joints)
