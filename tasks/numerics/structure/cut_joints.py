"""The joints of one cut of the body, and where they go; cuts in other poses have theirs elsewhere (ours)."""

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.inserted_bones import inserted_bones
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings, TreeJoints, tree_joints


def cut_tree(
    body: MovingSurface,
    cut: Cut,
    leaves: Ints,
    confidence: Floats | None,
    evidence: FrameEvidence | None,
    settings: KinematicTreeSettings,
) -> TreeJoints:
    """The tree of a cut; where every vertex was followed with the bones that no cut can find.

    leaves     : (leaf,) vertices at the ends of limbs
    confidence : (frame, vertex) 0 to 1; None where every vertex was followed
    evidence   : the frames' surfaces, which must show every joint; None asks for no evidence
    """
    found = tree_joints(body, cut, leaves, confidence, evidence, settings=settings)
    if confidence is not None or not settings.hidden_bones:
        return found
    return inserted_bones(body, found, settings.noise * body.size)


def cut_joints(
    body: MovingSurface, cut: Cut, leaves: Ints, confidence: Floats | None, settings: KinematicTreeSettings
) -> Floats:
    """The joints of another cut of the same body, but for its root; the frames need not show them.

    leaves, confidence : as in `cut_tree`
    returns            : (frame, joint, xyz) mesh unit
    """
    found = cut_tree(body._replace(V=cut.V), cut, leaves, confidence, None, settings)
    return found.motion.carried(found.rest[1:])
