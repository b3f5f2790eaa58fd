"""The tree that the cuts agree on."""

from collections.abc import Mapping

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.agreed_tree import AgreedTree
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import AgreedTreeParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.structure import agreed_tree as numerics
from kinetree.tasks.numerics.structure.agreeing_cut import agreeing_cut
from kinetree.tasks.numerics.structure.end_joints import judged_runs
from kinetree.tasks.structure.arguments.aligned_body import aligned_body
from kinetree.tasks.structure.arguments.frame_evidence import frame_evidence
from kinetree.tasks.structure.arguments.joint_tree import fields_of, restored
from kinetree.tasks.structure.first_tree import tree_settings


@task(among=Sequence, block="kinematic_tree")
def agreed_tree(
    reference: Reference,
    first_tree: FirstTree,
    further_cut: Mapping[int, FurtherCut],
    alignment: Mapping[int, Alignment],
    mesh: Mapping[int, Mesh],
    leaves: Leaves,
    params: AgreedTreeParams,
) -> AgreedTree:
    """Says whose tree is used, without joints that no other cut has, and in which frames ends are judged (ours)."""
    frames, body = first_tree.frames, aligned_body(reference, alignment, leaves)
    trees = [restored(tree) for tree in (first_tree, *further_cut.values())]
    if body.is_given:
        which = agreeing_cut(trees, body.surface.size)
        tree = trees[which]
    else:
        evidence, settings = frame_evidence(body, alignment, mesh, params), tree_settings(params)
        which, tree = numerics.agreed_tree(body.surface, trees, body.tips, body.confidence, evidence, settings=settings)
    is_judged = params.end_joints and body.confidence is not None
    runs = judged_runs(len(frames), body.surface.takes) if is_judged else []
    return AgreedTree(
        frames=frames,
        judged=tuple(tuple(frames[t] for t in run) for run in runs),
        cut_frame=list(further_cut)[which - 1] if which else None,
        is_given=body.is_given,
        **fields_of(tree),
    )
