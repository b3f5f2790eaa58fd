"""The joints of one cut of the body, and where they go; cuts in other poses have theirs elsewhere (ours)."""

from typing import NamedTuple

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.inserted_bones import inserted_bones
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.loose_parts import tightened
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.slabs import bones_without_slabs
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings, TreeJoints, tree_joints


class CutTrees(NamedTuple):
    """What another cut of the body gives.

    tree       : its tree as `cut_tree` would make it without evidence, in its own pose
    bare       : the same without bones that no cut can find
    with_bones : the same with them, and with slabs beside them
    """

    tree: TreeJoints
    bare: TreeJoints
    with_bones: TreeJoints


def cut_tree(
    body: MovingSurface,
    cut: Cut,
    leaves: Ints,
    confidence: Floats | None,
    evidence: FrameEvidence | None,
    settings: KinematicTreeSettings,
) -> TreeJoints:
    """The tree of a cut; where every vertex was followed with the bones that no cut can find, and with loose parts moved anew.

    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    evidence   : the frames' surfaces, which must show every joint; None asks for no evidence
    """
    found = tree_joints(body, cut, leaves, confidence, evidence, settings=settings)
    if not _looks_for_bones(confidence, settings):
        return found
    noise = settings.noise * body.size
    return tightened(body, bones_without_slabs(body, found, settings), noise)


def cut_trees(
    body: MovingSurface, cut: Cut, leaves: Ints, confidence: Floats | None, settings: KinematicTreeSettings
) -> CutTrees:
    """The trees of another cut of the same body; the frames need not show its joints.

    Whether the body has bones that no cut can find is for the cut to say whose tree is used, so that both are given. Slabs
    beside them stay for their joints' sake: these have no partner in that tree, and chests are placed better with them.

    leaves, confidence : as in `cut_tree`
    """
    posed, noise = body._replace(V=cut.V), settings.noise * body.size
    found = tree_joints(posed, cut, leaves, confidence, settings=settings)
    if not _looks_for_bones(confidence, settings):
        return CutTrees(found, found, found)
    bare, whole = tightened(posed, found, noise), tightened(posed, inserted_bones(posed, found, noise), noise)
    if len(body.takes or ()) < 2:
        return CutTrees(whole, bare, whole)
    return CutTrees(tightened(posed, bones_without_slabs(posed, found, settings), noise), bare, whole)


def _looks_for_bones(confidence: Floats | None, settings: KinematicTreeSettings) -> bool:
    """Errors of an alignment look like bones that no cut can find, so that every vertex must have been followed."""
    return confidence is None and settings.hidden_bones
