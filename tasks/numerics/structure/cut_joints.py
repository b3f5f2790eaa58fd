"""The joints of one cut of the body, and where they go; cuts in other poses have theirs elsewhere (ours)."""

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.inserted_bones import inserted_bones
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.loose_parts import tightened
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.slabs import bones_without_slabs
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings, TreeJoints, tree_joints


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


def cut_joints(
    body: MovingSurface, cut: Cut, leaves: Ints, confidence: Floats | None, settings: KinematicTreeSettings
) -> tuple[Floats, Floats]:
    """The joints of another cut of the same body, but for its root; the frames need not show them.

    Whether the body has bones that no cut can find is for the first cut to say, so that both are given. Slabs beside them stay:
    their joints have no partner in the first cut, and chests are placed better with them.

    leaves, confidence : as in `cut_tree`
    returns            : (frame, joint, xyz) without such bones · (frame, joint, xyz) with them, mesh unit
    """
    posed, noise = body._replace(V=cut.V), settings.noise * body.size
    whole = found = tree_joints(posed, cut, leaves, confidence, settings=settings)
    if _looks_for_bones(confidence, settings):
        whole = tightened(posed, inserted_bones(posed, found, noise), noise)
        found = tightened(posed, found, noise)
    return found.motion.carried(found.rest[1:]), whole.motion.carried(whole.rest[1:])


def _looks_for_bones(confidence: Floats | None, settings: KinematicTreeSettings) -> bool:
    """Errors of an alignment look like bones that no cut can find, so that every vertex must have been followed."""
    return confidence is None and settings.hidden_bones
