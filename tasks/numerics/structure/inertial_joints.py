"""Joints within limbs that are none: soft flesh that stays behind its bone bends there (ours, see `inertia`)."""

from collections.abc import Mapping

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.structure.end_joints import EndJointsSettings
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.inertia import Turns, beyond_inertia, inertial_turns
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import FLESH
from kinetree.tasks.numerics.structure.refitted_tree import refitted_tree
from kinetree.tasks.numerics.structure.ring_evidence import about_mean, agreeing_turn, going_on, judged_frames
from kinetree.tasks.numerics.structure.score_spans import score_spans
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence, of_mirrored_limbs
from kinetree.tasks.numerics.structure.without_joint import without_joint

SHARE = 0.5
"""Share of a joint's turn that inertia leaves unexplained, at most, of one that is none. False joints in hands and forearms and
amid a shank have 0.13 to 0.34 (people 15, 16, 719, and 737, 748, 750 with 12,000 vertices); of true joints that swing with
their limb some have 0.2 to 0.5, but turn farther."""

DEGREES = 2.0
"""Root mean square turn, as far as it agrees from frame to frame, that inertia leaves unexplained, below which there is no
joint; as `EvidentRingsSettings.degrees`. Those false ones have 0.5 to 1.5; of true ones with a share below a half the least has
2.3 (random tree 16), the others 2.8 and more."""


def without_inertial_joints(body: MovingSurface, tree: FirstTree, pairs: LimbPairs, evidence: SurfaceEvidence) -> FirstTree:
    """The tree without joints within limbs with a mirror image whose turn inertia explains in every take.

    Where frames are too far apart for turns to go on from one to the next, accelerations say nothing, and every joint stays.

    tree : without joints that surfaces alone show
    """
    visible = evidence.frames(body, tree).visible
    flesh = [part for part in _within_limbs(tree, pairs) if _is_flesh(body, tree, part, visible)]
    for vertex in [int(np.flatnonzero(tree.label == part)[0]) for part in flesh]:
        tree = _as_one(body, tree, int(tree.label[vertex]), evidence)
    return tree


def _within_limbs(tree: FirstTree, pairs: LimbPairs) -> list[int]:
    """Parts of limbs with a mirror image that carry one part at most, on another that carries nothing else."""
    carried, mirrored = np.bincount(tree.parents[1:], minlength=len(tree.parents)), of_mirrored_limbs(tree, pairs)
    is_within = (carried <= 1) & (carried[tree.parents] == 1) & (tree.parents > 0)
    return np.flatnonzero(is_within & mirrored & mirrored[tree.parents]).tolist()


def _is_flesh(body: MovingSurface, tree: FirstTree, part: int, visible: Mapping[int, Flags]) -> bool:
    """Whether some take says that inertia explains the turn of a joint, and none that it does not."""
    above, settings = int(tree.parents[part]), EndJointsSettings()
    turn = {f: tree.R[f, above].T @ tree.R[f, part] for f in visible if visible[f][part]}
    _, follow = judged_frames(len(tree.R), body.takes, len(tree.R))
    inertia, judged = _inertia(body, tree, part), list[bool]()
    for first, after in score_spans(len(tree.R), body.takes).tolist():
        within = np.array([pair for pair in follow.tolist() if first <= pair[0] and pair[1] < after and turn.keys() >= {*pair}])
        if len(within) and going_on(tree.R, tree.parents, within, settings.evident.nearer) >= settings.goes_on:
            w = about_mean({f: Q for f, Q in turn.items() if first <= f < after})
            share = beyond_inertia(w, inertia, within)
            one, next_one = (np.array([w[f] for f in side]) for side in within.T.tolist())
            judged.append(share < SHARE and np.sqrt(share) * agreeing_turn(one, next_one) < DEGREES)
    return bool(judged) and all(judged)


def _inertia(body: MovingSurface, tree: FirstTree, part: int) -> Turns:
    """How flesh would turn a joint if its two parts were one, which moves as the one above."""
    above = int(tree.parents[part])
    middle: Floats = body.V[np.isin(tree.label, [above, part])].mean(axis=0)
    return inertial_turns(middle, tree.rest[part] - tree.rest[above], tree.R[:, above], tree.t[:, above], body.takes)


def _as_one(body: MovingSurface, tree: FirstTree, part: int, evidence: SurfaceEvidence) -> FirstTree:
    """The tree with the two parts of a joint as one, which moves as the vertices of both do."""
    vertex = int(np.flatnonzero(tree.label == part)[0])
    one = without_joint(body, tree, part, evidence, FLESH)
    return refitted_tree(body, one, [int(one.label[vertex])], evidence)
