"""A tree as it is stored and as the numerics take it."""

from typing import Any

import numpy as np

from kinetree.schemas.structure.extended_tree import ExtendedTree
from kinetree.schemas.structure.first_tree import JointTree
from kinetree.tasks.numerics.structure import first_tree as numerics
from kinetree.tasks.numerics.structure.pruning import Dropped

SAME = ("place", "label", "rest", "drift", "unexplained", "radius")
"""Fields that the artifact and the numerics call the same."""


def fields_of(tree: numerics.FirstTree) -> dict[str, Any]:
    """What artifacts of a tree have in common, but for the frames' numbers."""
    return {
        "parents": tuple(tree.parents.tolist()),
        "followed": tree.certain_share is None,
        "skin": tree.W,
        "rotation": tree.R,
        "translation": tree.t,
        "certain_share": np.ones(tree.R.shape[:2]) if tree.certain_share is None else tree.certain_share,
        **{name: getattr(tree, name) for name in SAME},
        **tree.graph._asdict(),
        "dropped": tuple((d.part, d.reason) for d in tree.graph.dropped),
    }


def restored(tree: JointTree) -> numerics.FirstTree:
    """What the numerics take of a tree; of the first one no joint at an end is known yet."""
    graph = {name: np.array(getattr(tree, name)) for name in numerics.PartGraph._fields if name != "dropped"}
    same = {name: np.array(getattr(tree, name)) for name in SAME}
    shown: tuple[int, ...] = ()
    end_x = np.zeros((len(tree.frames), 0, 3))
    if isinstance(tree, ExtendedTree):
        shown, end_x = tree.shown, np.array(tree.end_positions)
    return numerics.FirstTree(
        parents=np.array(tree.parents, np.int64),
        shown=shown,
        W=np.array(tree.skin),
        R=np.array(tree.rotation),
        t=np.array(tree.translation),
        certain_share=None if tree.followed else np.array(tree.certain_share),
        end_x=end_x,
        graph=numerics.PartGraph(**graph, dropped=tuple(Dropped(*d) for d in tree.dropped)),
        **{**same, "label": np.array(tree.label, np.int64)},
    )
