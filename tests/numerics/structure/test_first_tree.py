"""The tree of the first cut, as other steps read it."""

import numpy as np
from articulated import chain, neck, swings
from shipped import TREE
from smeared import moving

from kinetree.tasks.numerics.structure.first_tree import first_tree, in_tree_order
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints

NO_LEAVES = np.zeros(0, int)


def test_a_part_knows_its_place_and_one_that_was_dropped_has_none() -> None:
    turn = swings(24, 3)
    turn[:, 2] = np.eye(3)
    body = chain((-1.0, 2.0), turn)
    tree = first_tree(moving(body), Cut(body.V, body.label, body.R, body.t, body.residual), NO_LEAVES, settings=TREE)
    (dropped,) = tree.graph.dropped
    assert tree.place[dropped.part] == -1
    for part in {0, 1, 2} - {dropped.part}:
        np.testing.assert_array_equal(tree.R[:, tree.place[part]], body.R[:, part])


def test_bones_that_no_cut_finds_are_recognised() -> None:
    body = neck()
    ends = [0, body.R.shape[1] - 1]
    cut = Cut(body.V, (body.V[:, 2] > 0.0).astype(np.int64), body.R[:, ends], body.t[:, ends], body.residual[:, ends])
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    trees = [first_tree(moving(body), cut, tips, settings=TREE._replace(hidden_bones=h)) for h in (True, False)]
    assert [tree.has_bones for tree in trees] == [True, False]


def test_joints_drift_as_much_as_where_they_were_found() -> None:
    body = chain((0.0,), swings(16, 2))
    cut = Cut(body.V, body.label, body.R, body.t, body.residual)
    found = tree_joints(moving(body), cut, NO_LEAVES, settings=TREE)
    tree = in_tree_order(found, 2)
    np.testing.assert_allclose(tree.drift_at(tree.rest), found.drift, atol=1e-12)
    assert tree.drift_at(tree.rest + 1.0)[1] > tree.drift[1]
    np.testing.assert_array_equal(tree.motion.R, found.motion.R)
