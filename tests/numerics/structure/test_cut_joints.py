"""The joints of a cut in another pose."""

import numpy as np
from articulated import ALL_STAY, Known, chain, cut_by_height, neck, swings
from shipped import TREE

from kinetree.tasks.numerics.structure.cut_joints import cut_tree, cut_trees
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut, TreeJoints

NO_LEAVES = np.zeros(0, int)
SETTINGS = TREE._replace(hidden_bones=False)


def surface(body: Known) -> MovingSurface:
    return MovingSurface(body.V, body.F, body.x, body.area, None)


def of(tree: TreeJoints) -> np.ndarray:
    """(frame, joint, xyz) where its parts carry its joints."""
    return tree.motion.carried(tree.rest[1:])


def in_pose(body: Known, k: int) -> Cut:
    """The true parts as a cut in the pose of a frame gives them."""
    R = np.einsum("tpxy,pzy->tpxz", body.R, body.R[k])
    return Cut(body.x[k], body.label, R, body.t - np.einsum("tpxy,py->tpx", R, body.t[k]), body.residual)


def test_a_cut_in_another_pose_has_its_joints_in_the_same_places() -> None:
    body = chain((0.0,), swings(16, 2))
    own = Cut(body.V, body.label, body.R, body.t, body.residual)
    first, other = (of(cut_trees(surface(body), cut, NO_LEAVES, None, SETTINGS).bare) for cut in (own, in_pose(body, 3)))
    assert first.shape == (len(body.x), 1, 3)
    np.testing.assert_allclose(other, first, atol=0.01 * np.sqrt(body.area.sum()))
    found = cut_tree(surface(body), own, NO_LEAVES, None, None, SETTINGS)
    np.testing.assert_array_equal(of(found), first)


def test_joints_are_given_with_hidden_bones_and_without() -> None:
    body = neck()
    ends = [0, body.R.shape[1] - 1]
    cut = Cut(body.V, (body.V[:, 2] > 0.0).astype(np.int64), body.R[:, ends], body.t[:, ends], body.residual[:, ends])
    tips, counts = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()]), []
    for is_asked, confidence in ((True, None), (False, None), (True, np.full(body.x.shape[:2], 0.99))):
        found = cut_trees(surface(body), cut, tips, confidence, TREE._replace(hidden_bones=is_asked))
        counts.append([of(found.bare).shape[1], of(found.with_bones).shape[1]])
        np.testing.assert_array_equal(of(found.tree), of(found.with_bones))
    assert counts == [[1, 2], [1, 1], [1, 1]]


def test_of_several_takes_the_tree_has_no_slab_and_the_joints_beside_the_first_cut_have_it() -> None:
    body = chain((-0.9, 0.9), swings(24, 3, 20.0, seed=3), blend=2.4, along=60)
    amiss = cut_by_height(body, (0.0, 1.7)).left.parts
    cut = Cut(body.V, amiss.label, amiss.R, amiss.t, np.zeros(amiss.R.shape[:2]))
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    counts = []
    for takes in (None, [slice(0, 12), slice(12, 24)]):
        moving, settings = surface(body)._replace(takes=takes), ALL_STAY._replace(hidden_bones=True)
        found = cut_trees(moving, cut, tips, None, settings)
        counts.append([of(tree).shape[1] for tree in (found.bare, found.with_bones, found.tree)])
    assert counts == [[2, 3, 3], [2, 3, 2]]
