"""A tree some of whose parts move as their aligned vertices do now: what follows once parts have other vertices (ours)."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.limbs_apart import moving_by_themselves
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence


def refitted_tree(
    body: MovingSurface,
    tree: FirstTree,
    some: Sequence[int],
    evidence: SurfaceEvidence,
    skinned: MovingSurface | None = None,
) -> FirstTree:
    """The tree with some parts fitted anew; the skin and the drift of their joints follow.

    some    : parts, by their places in the tree
    skinned : the body by which skin is weighed; None takes the same
    """
    parts = MovingParts(tree.label, tree.R, tree.t, tree.unexplained, tree.certain_share)
    fitted = moving_by_themselves(body, parts, some, evidence.confidence)
    of = (tree.label, fitted.R, fitted.t, tree.parents, evidence.confidence, evidence.noise)
    W = skinning(body.V, body.F, (skinned or body).x, *of)
    new = tree._replace(R=fitted.R, t=fitted.t, unexplained=fitted.residual, W=W)
    beside = np.isin(np.arange(len(tree.parents)), some) | np.isin(tree.parents, some)
    return new._replace(drift=np.where(beside, new.drift_at(new.rest), tree.drift))
