"""Parts on surfaces as the task gives them."""

import numpy as np
from aligned_body import agreed, extended, tube

from kinetree.schemas.structure.kinematic_tree import FirstTreeParams
from kinetree.schemas.structure.laid_parts import LaidParts
from kinetree.tasks.structure.arguments.laid_parts import joined
from kinetree.tasks.structure.first_tree import first_tree
from kinetree.tasks.structure.laid_parts import laid_parts


def runs() -> list[LaidParts]:
    """A few frames at a time."""
    reference, parts, alignment, mesh, leaves = tube(0.99)
    first = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams())
    tree = extended(agreed(first, reference, alignment, mesh, leaves), reference, alignment, mesh, leaves)
    members = (tree.members("laid/frame", (k,)) for k in tree.members("laid", ()))
    return [laid_parts(reference, tree, {f: mesh[f] for f in run}) for run in members]


def test_runs_of_frames_together_are_all_frames_in_order() -> None:
    laid = joined(tuple(runs()))
    assert laid is not None
    assert laid.frame.tolist() == list(range(24))
    assert laid.joint.tolist() == [0, 1, 2], "also of the part beyond the joint that the frames alone show"
    assert laid.stiffness.shape == (24, 3, 6, 6)
    np.testing.assert_array_equal(laid.rotation[2:4], runs()[1].rotation)


def test_of_no_frames_nothing_is_moved() -> None:
    assert joined(()) is None
