"""The finished body from its parts at once, as the tasks make it one after the other."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.structure.cut_joints import cut_joints
from kinetree.tasks.numerics.structure.first_tree import first_tree
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree, kinematic_tree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings


def whole_tree(
    body: MovingSurface,
    cut: Cut,
    leaves: np.ndarray,
    confidence: np.ndarray | None = None,
    evidence: FrameEvidence | None = None,
    *,
    settings: KinematicTreeSettings,
    further: Sequence[Cut] = (),
) -> tuple[KinematicTree, Derivation]:
    """The body, and how it came about; arguments as of the numerics."""
    first = first_tree(body, cut, leaves, confidence, evidence, settings=settings)
    joints = [cut_joints(body, other, leaves, confidence, settings)[first.has_bones] for other in further]
    return kinematic_tree(body, first, leaves, confidence, settings=settings, further=joints)
