"""The first tree without joints that no other cut has."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.agreed_tree import AgreedTree
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import AgreedTreeParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure import agreed_tree as numerics
from kinetree.tasks.numerics.structure.end_joints import judged_runs
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.joint_tree import fields_of, restored
from kinetree.tasks.structure.first_tree import tree_settings


@task(among=Sequence, block="kinematic_tree")
def agreed_tree(
    reference: Reference,
    first_tree: FirstTree,
    further_cut: Mapping[int, FurtherCut],
    alignment: Mapping[int, Alignment],
    leaves: Leaves,
    params: AgreedTreeParams,
) -> AgreedTree:
    """Drops joints that no other cut has and that the tree does not need, and says in which frames ends are judged (ours)."""
    frames, body, tree = first_tree.frames, aligned_body(reference, alignment, leaves), restored(first_tree)
    if not body.is_given:
        others = [np.array(cut.bare_joints) for cut in further_cut.values()]
        settings = tree_settings(params)
        tree = numerics.agreed_tree(body.surface, tree, body.tips, body.confidence, others, settings=settings)
    is_judged = params.end_joints and body.confidence is not None
    runs = judged_runs(len(frames), body.surface.takes) if is_judged else []
    judged = tuple(tuple(frames[t] for t in run) for run in runs)
    return AgreedTree(frames=frames, judged=judged, is_given=body.is_given, **fields_of(tree))
