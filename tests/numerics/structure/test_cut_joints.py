"""The joints of a cut in another pose, and that they are known before the tree is made."""

import numpy as np
import pytest
from articulated import Known, chain, swings
from shipped import TREE

from kinetree.tasks.numerics.structure.cut_joints import cut_joints, cut_tree
from kinetree.tasks.numerics.structure.kinematic_tree import kinematic_tree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut

NO_LEAVES = np.zeros(0, int)
SETTINGS = TREE._replace(hidden_bones=False)


def surface(body: Known) -> MovingSurface:
    return MovingSurface(body.V, body.F, body.x, body.area, None)


def in_pose(body: Known, k: int) -> Cut:
    """The true parts as a cut in the pose of a frame gives them."""
    R = np.einsum("tpxy,pzy->tpxz", body.R, body.R[k])
    return Cut(body.x[k], body.label, R, body.t - np.einsum("tpxy,py->tpx", R, body.t[k]), body.residual)


def test_a_cut_in_another_pose_has_its_joints_in_the_same_places() -> None:
    body = chain((0.0,), swings(16, 2))
    own = Cut(body.V, body.label, body.R, body.t, body.residual)
    first, other = (cut_joints(surface(body), cut, NO_LEAVES, None, SETTINGS) for cut in (own, in_pose(body, 3)))
    assert first.shape == (len(body.x), 1, 3)
    np.testing.assert_allclose(other, first, atol=0.01 * np.sqrt(body.area.sum()))
    found = cut_tree(surface(body), own, NO_LEAVES, None, None, SETTINGS)
    np.testing.assert_array_equal(found.motion.carried(found.rest[1:]), first)


def test_joints_that_are_known_already_are_averaged_as_those_of_cuts_are() -> None:
    body = chain((0.0,), swings(16, 2))
    known = body.V, body.F, body.x, body.area, body.label, body.R, body.t, body.residual
    cuts = [in_pose(body, k) for k in (3, 9)]
    carried = [cut_joints(surface(body), cut, NO_LEAVES, None, SETTINGS) for cut in cuts]
    by_cuts, told = kinematic_tree(*known, NO_LEAVES, settings=SETTINGS, further=cuts)
    by_joints, same = kinematic_tree(*known, NO_LEAVES, settings=SETTINGS, carried=carried)
    np.testing.assert_array_equal(by_joints.positions, by_cuts.positions)
    np.testing.assert_array_equal(same.spread, told.spread)
    off, _ = kinematic_tree(*known, NO_LEAVES, settings=SETTINGS, carried=[c + 0.01 for c in carried])
    assert off.rest[1] != pytest.approx(by_cuts.rest[1], abs=1e-3)
