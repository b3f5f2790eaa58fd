"""Last joints of limbs that are none: soft flesh that stays behind its bone bends there (ours, see `inertia`)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.end_joints import EndJointsSettings
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.inertia import Turns, beyond_inertia, inertial_turns
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import FLESH
from kinetree.tasks.numerics.structure.ring_evidence import about_mean, going_on, judged_frames
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.smeared_ends import close_ends
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence
from kinetree.tasks.numerics.structure.without_joint import without_joint

LEAST = 0.28
"""Share of a joint's turn that inertia must leave unexplained. In hands of four people (719, and 737, 748 and 750 with 12,000
vertices) false joints have 0.13 to 0.20. True last joints of people 685 to 694, 705 to 724 and those with 12,000 vertices have
0.37 (a ball of the foot 1.8 % of the height off), 0.47 and more."""


def without_inertial_ends(body: MovingSurface, tree: FirstTree, pairs: LimbPairs, evidence: SurfaceEvidence) -> FirstTree:
    """The tree without last joints of limbs with a mirror image that lie close to the one before and that inertia explains.

    It must do so in every take.

    Where frames are too far apart for turns to go on from one to the next, accelerations say nothing, and every joint stays.

    tree : without joints that surfaces alone show
    """
    flesh = [part for part in close_ends(tree, pairs) if _left_by_inertia(body, tree, part, evidence) < LEAST]
    for vertex in [int(np.flatnonzero(tree.label == part)[0]) for part in flesh]:
        tree = without_joint(body, tree, int(tree.label[vertex]), evidence, FLESH)
    return tree


def _left_by_inertia(body: MovingSurface, tree: FirstTree, part: int, evidence: SurfaceEvidence) -> float:
    """Share of a joint's turn that inertia leaves unexplained, in the take in which it is largest."""
    above, settings = int(tree.parents[part]), EndJointsSettings()
    visible = evidence.frames(body, tree).visible
    turn = {f: tree.R[f, above].T @ tree.R[f, part] for f in visible if visible[f][part]}
    _, follow = judged_frames(len(tree.R), body.takes, len(tree.R))
    flesh = _of_flesh(body, tree, part)
    shares = []
    for first, after in score_spans(len(tree.R), body.takes).tolist():
        own = {f: Q for f, Q in turn.items() if first <= f < after}
        within = follow[(follow >= first).all(axis=1) & (follow < after).all(axis=1)]
        if len(own) and len(within) and going_on(tree.R, tree.parents, within, settings.evident.nearer) >= settings.goes_on:
            shares.append(beyond_inertia(about_mean(own), flesh, within))
    return max(shares, default=1.0)


def _of_flesh(body: MovingSurface, tree: FirstTree, part: int) -> Turns:
    """How flesh would turn a joint if its two parts were one, which moves as the one above."""
    above = int(tree.parents[part])
    middle: Floats = body.V[np.isin(tree.label, [above, part])].mean(axis=0)
    return inertial_turns(middle, tree.rest[part] - tree.rest[above], tree.R[:, above], tree.t[:, above], body.takes)
