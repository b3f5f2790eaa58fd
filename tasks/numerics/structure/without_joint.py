"""A tree without one of its joints, so that the frames' surfaces can be asked what is there (ours, see `shown_joints`)."""

import numpy as np

from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import Dropped
from kinetree.tasks.numerics.structure.skinning import skinning
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence


def without_joint(body: MovingSurface, tree: FirstTree, joint: int, evidence: SurfaceEvidence, reason: str) -> FirstTree:
    """The tree with the two parts of a joint as one, which moves as the one above did; all other joints stay where they are.

    What moves otherwise follows the part less (`skinning`) and counts less across its rings. So these tell first where that
    begins, which is at one end of what lies between two joints, and not midway.

    tree   : without joints that surfaces alone show
    joint  : by the part that turns about it, not the root
    reason : for which the part is dropped
    """
    above, others = int(tree.parents[joint]), np.arange(len(tree.parents)) != joint
    number = np.cumsum(others) - 1
    number[joint] = number[above]
    gone = tuple(Dropped(int(part), reason) for part in np.flatnonzero(tree.place == joint))
    parents, label = tree.parents[others], number[tree.label]
    parents = np.where(parents < 0, -1, number[parents])
    R, t = (np.ascontiguousarray(a[:, others]) for a in (tree.R, tree.t))
    left = tree._replace(
        parents=parents,
        place=np.where((tree.place < 0) | (tree.place == joint), -1, number[tree.place]),
        label=label,
        W=skinning(body.V, body.F, body.x, label, R, t, parents, evidence.confidence, evidence.noise),
        R=R,
        t=t,
        certain_share=None if tree.certain_share is None else tree.certain_share[:, others],
        rest=tree.rest[others],
        unexplained=tree.unexplained[:, others],
        radius=tree.radius[others],
        graph=tree.graph._replace(dropped=(*tree.graph.dropped, *gone)),
    )
    return left._replace(drift=np.where(parents == number[above], left.drift_at(left.rest), tree.drift[others]))
