"""Last joints of limbs that an alignment smears: the frames' surfaces say where they are, if asked without them (ours).

An alignment spreads the turn of a ball of the foot over the foot, so that a cut has it anywhere up to the ankle. A ring keeps a
distance from joints that are there, so that it does not show the true one then, or shows it as one more.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags
from kinetree.tasks.numerics.structure.end_joints import EndJointsSettings, end_joints, judged_runs
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import SMEARED
from kinetree.tasks.numerics.structure.surface_evidence import KnownFits, SurfaceEvidence, all_end_rings, of_mirrored_limbs
from kinetree.tasks.numerics.structure.without_joint import without_joint

CLOSE = 3.1
"""Distance of a limb's last joint from the one before, in radii of its border, below which both are close.
Rings take the place of balls of feet that lie at 1.3 to 3 radii; true balls are at 2.7 to 3.9. With 4.5 three paws come nearer
too, but an elbow beyond a slice of the shoulder goes astray."""

CLOSE_IF_SINGLE = 1.3
"""The same of limbs without a mirror image, as necks: a cut may have one more joint amid a soft neck (person 754, at 1.1), so
that the ring beyond, which shows the head's, is one more. Of 130 other people, generated and recorded bodies, as captured, no
limb has one below 1.34."""


def without_smeared_ends(
    body: MovingSurface, tree: FirstTree, known: KnownFits, pairs: LimbPairs, evidence: SurfaceEvidence
) -> FirstTree:
    """The tree without the last joints of limbs that lie close to the joint before, where surfaces show one without them.

    known : has the fits of all rings that were asked afterwards
    """
    chosen = EndJointsSettings()
    runs = judged_runs(len(body.x), body.takes, chosen)
    asked = [*close_ends(tree, pairs), *_of_single_limbs(tree, pairs)]
    for vertex in [int(np.flatnonzero(tree.label == k)[0]) for k in asked]:
        one = without_joint(body, tree, int(tree.label[vertex]), evidence, SMEARED)
        part, frames = int(one.label[vertex]), evidence.frames(body, one)
        rings = [ring for ring in all_end_rings(body.V, body.F, body.area, one, pairs) if ring.cut.part == part]
        if end_joints(frames, rings, known.laid(frames, runs, rings), body.takes, chosen):
            tree = one
    return tree


def are_replaced(tree: FirstTree, left: FirstTree, extended: FirstTree) -> bool:
    """Whether surfaces that are asked for all joints at once show one for each that went: what was two parts is two again.

    left     : the tree without these joints
    extended : the same with those that the surfaces show
    """
    gone = tree.place[(tree.place >= 0) & (left.place < 0)].tolist()
    return all(len(np.unique(extended.label[np.isin(tree.label, [k, tree.parents[k]])])) > 1 for k in gone)


def close_ends(tree: FirstTree, pairs: LimbPairs) -> list[int]:
    """Last parts of limbs with a mirror image whose joint lies close to the one before, which carries nothing else."""
    return np.flatnonzero(_is_last_within(tree, CLOSE) & of_mirrored_limbs(tree, pairs)).tolist()


def _of_single_limbs(tree: FirstTree, pairs: LimbPairs) -> list[int]:
    """The same of limbs without one."""
    return np.flatnonzero(_is_last_within(tree, CLOSE_IF_SINGLE) & ~of_mirrored_limbs(tree, pairs)).tolist()


def _is_last_within(tree: FirstTree, radii: float) -> Flags:
    """(part,) whether a part is the last of a limb, on another that carries nothing else, and both joints so close."""
    apart = np.linalg.norm(tree.rest - tree.rest[tree.parents], axis=1)
    carried = np.bincount(tree.parents[1:], minlength=len(tree.parents))
    is_last = (carried == 0) & (carried[tree.parents] == 1) & (tree.parents > 0)
    return np.asarray(is_last & (apart < radii * tree.radius))
