"""Joints that a cut has close to one of the trunk that the frames' surfaces show: may be the same one, smeared (ours).

An alignment spreads the turn of a spine over the trunk, so that a cut may have a joint beside the true one. A ring then shows
the true one as one more, if it lies far enough away. Of one amid two that are right see `trunk_bends`.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.surface_evidence import of_mirrored_limbs

CLOSE = 1.0
"""Distance of a joint from one of the trunk that the surfaces show, in radii of the smaller border, below which they are asked
without it. Three false joints lie at 0.68 to 0.79; a true one of the ballet, whose spine bends everywhere, lies at 1.2 and
would go. Chosen on people 545 to 569, 1, 8 and 12, generated bodies 0 to 9 and recorded ones; see RESULTS."""

AS_WELL = 1.18
"""What the motions of the trunk's parts leave unexplained without such a joint, in what they leave with it, at most. Chosen on
the same bodies: those three have 1.00 to 1.12, true ones as close 1.28 to 1.7; of others a false one 1.23, a true one 1.24."""

AS_WELL_WITH_FEWER = 1.05
"""The same where surfaces show fewer joints of the trunk then: two joints fewer explain as much. Person 743 has 1.01, and both
were false."""

DRIFT_WITH_FEWER = 1.5
"""The largest drift of a joint then, in the largest before, at most: of person 770, who has 0.97, shoulders would drift ten
times as far. What is left unexplained does not show that."""


def close_joints(tree: FirstTree, extended: FirstTree, pairs: LimbPairs) -> list[int]:
    """Joints of a tree beside one of the trunk that surfaces show, the closest first; none of limbs with a mirror image.

    tree     : without joints that surfaces alone show
    extended : the same with them
    """
    of_trunk, place = ~of_mirrored_limbs(tree, pairs), {}
    for given in np.flatnonzero(tree.place > 0).tolist():
        if of_trunk[tree.place[given]]:
            place[int(tree.place[given])] = int(extended.place[given])
    apart = {joint: _radii_apart(extended, own) for joint, own in place.items()}
    return sorted((joint for joint in apart if apart[joint] < CLOSE), key=lambda joint: apart[joint])


def are_as_good(area: Floats, extended: FirstTree, without: FirstTree, pairs: LimbPairs) -> bool:
    """Whether surfaces show as many joints without a close one, and the trunk's parts leave hardly more unexplained.

    With fewer joints of the trunk these must leave no more, and no joint must drift farther.

    area     : (vertex,) mesh unit²
    extended : the tree with the joint, and with those that surfaces show
    without  : the same without it
    """
    before, after = (_is_within(tree)[[*tree.shown]] for tree in (extended, without))
    if (~after).sum() < (~before).sum():
        return False
    of_trunk = ~of_mirrored_limbs(extended, pairs)[extended.label]
    left = [_unexplained(tree, np.where(of_trunk, area, 0.0)) for tree in (extended, without)]
    if after.sum() >= before.sum():
        return left[1] <= AS_WELL * left[0]
    drift = [float(tree.drift.max()) for tree in (extended, without)]
    return left[1] <= AS_WELL_WITH_FEWER * left[0] and drift[1] <= DRIFT_WITH_FEWER * drift[0]


def _radii_apart(extended: FirstTree, joint: int) -> float:
    """Distance of a joint from the nearest of the trunk that surfaces show and that shares a part with it, in radii."""
    own = {joint, int(extended.parents[joint])}
    is_within, nearest = _is_within(extended), np.inf
    for k in extended.shown:
        if is_within[k] and k != joint and own & {k, int(extended.parents[k])}:
            radius = max(float(extended.radius[[k, joint]].min()), float(np.finfo(float).tiny))
            nearest = min(nearest, float(np.linalg.norm(extended.rest[k] - extended.rest[joint])) / radius)
    return nearest


def _is_within(tree: FirstTree) -> Flags:
    """(part,) whether a part carries another one."""
    return np.isin(np.arange(len(tree.parents)), tree.parents)


def _unexplained(tree: FirstTree, area: Floats) -> float:
    """Root mean square of what the motions of parts leave unexplained, by area (vertex,); mesh unit."""
    of_parts = np.bincount(tree.label, area, len(tree.parents))
    return float(np.sqrt((tree.unexplained**2).mean(axis=0) @ of_parts / max(float(of_parts.sum()), np.finfo(float).tiny)))
