"""Joints of the trunk, and the borders of their parts, go to where surfaces bend, if halves of the frames agree on each."""

from functools import cache

import numpy as np
import pytest
from articulated import swings
from smeared import END, Frames, turning
from trunk import trunk_with_two_joints, two_pairs, with_joint_amid

from kinetree.tasks.numerics.structure.close_joints import CLOSE
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence, all_end_rings
from kinetree.tasks.numerics.structure.trunk_bends import _is_settled, amid_two, roomy_rings, with_joints_at_bends

TRUE = (-1.2, 1.2)
"""Heights of the joints."""
TRUNK = (1, 2)


def bent(
    found: tuple[float, float], hidden: tuple[float, ...] = TRUE, frames: int = 24
) -> tuple[MovingSurface, FirstTree, SurfaceEvidence]:
    """A body that bends at some heights, the tree of a cut with joints at two others, and what the frames show."""
    turn = swings(24, len(hidden) + 2, 20.0, axes=1, seed=1)
    turn[:, -1] = turning()[:, 2]
    turn = turn[:frames]
    body, tree = trunk_with_two_joints(turn, hidden, found)
    surface = cache(Frames(turn, 0.02, heights=(*hidden, END)).prepared(body.size))
    return body, tree, SurfaceEvidence(surface, np.ones(body.x.shape[:2]), 0.002)


@pytest.mark.parametrize("off", [(0.4, 0.0), (-0.4, 0.3), (0.0, -0.4)])
def test_joints_and_borders_go_to_the_bends(off: tuple[float, float]) -> None:
    body, tree, evidence = bent((TRUE[0] + off[0], TRUE[1] + off[1]))
    after = with_joints_at_bends(body, tree, TRUNK, evidence)
    assert after is not None
    np.testing.assert_allclose(after.rest[[*TRUNK], 2], TRUE, atol=0.15)
    z = body.V[:, 2]
    for part, low, high in ((0, -3.0, -1.45), (1, -0.95, 0.95), (2, 1.45, END - 0.1)):
        assert (after.label[(z > low) & (z < high)] == part).all()
    others = [0, *range(3, 8)]
    np.testing.assert_array_equal(after.rest[others], tree.rest[others])
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)


def test_where_all_joints_are_right_the_tree_stays() -> None:
    body, tree, evidence = bent(TRUE)
    after = with_joints_at_bends(body, tree, TRUNK, evidence)
    assert after is not None
    np.testing.assert_allclose(after.rest, tree.rest, atol=0.1)


def test_parts_whose_border_moves_are_fitted_anew() -> None:
    body, tree, evidence = bent((TRUE[0] - 0.5, TRUE[1]))
    after = with_joints_at_bends(body, tree, TRUNK, evidence)
    assert after is not None
    own = after.label == 1

    def left(of: FirstTree) -> float:
        x = np.einsum("fxy,vy->fvx", of.R[:, 1], body.V[own]) + of.t[:, None, 1]
        return float(np.sqrt(((x - body.x[:, own]) ** 2).sum(axis=2).mean()))

    assert left(after) < 0.1 * left(tree)


def test_none_where_a_part_holds_a_joint_that_the_cut_has_not_found() -> None:
    hidden = (-2.0, 0.0, 2.0)
    body, tree, evidence = bent((-2.0, 1.0), hidden)
    assert with_joints_at_bends(body, tree, TRUNK, evidence) is None


def test_none_in_few_frames() -> None:
    body, tree, evidence = bent(TRUE, frames=5)
    assert with_joints_at_bends(body, tree, TRUNK, evidence) is None


@pytest.mark.parametrize(
    ("ways", "settled", "if_needed"),
    [((0.1, 0.3), True, True), ((0.1, 0.5), False, True), ((-0.2, 0.5), False, True), ((-0.3, 0.5), False, False),
     ((0.1, np.inf), False, False)],
)  # fmt: skip
def test_when_a_joint_is_settled(ways: tuple[float, ...], settled: bool, if_needed: bool) -> None:
    assert _is_settled(np.array(ways), False) == settled
    assert _is_settled(np.array(ways), True) == if_needed


@pytest.mark.parametrize(("shown", "amid"), [((2,), True), ((3,), False), ((1, 2), True)])
def test_which_joints_lie_amid_two_of_the_trunk(shown: tuple[int, ...], amid: bool) -> None:
    """The trunk's joints are 1, 2 and 3, from below."""
    body, two = trunk_with_two_joints(swings(24, 4, 20.0, axes=1, seed=1), (-1.0, 1.0), (-1.0, 1.0))
    tree = with_joint_amid(two, shown)
    assert amid_two(tree, two_pairs(body)) == ([2] if amid else [])
    assert amid_two(two._replace(shown=(1, 2)), two_pairs(body)) == [], "only one on either side"


def test_rings_between_two_joints_of_the_trunk_lie_a_radius_from_both() -> None:
    body, two = trunk_with_two_joints(swings(24, 4, 20.0, axes=1, seed=1), (-1.0, 1.0), (-1.0, 1.0))
    rings = all_end_rings(body.V, body.F, body.area, two, two_pairs(body))
    assert {0, 1, 2} <= {ring.cut.part for ring in rings}
    near, far = ([ring._replace(cut=ring.cut._replace(apart=factor * CLOSE)) for ring in rings] for factor in (0.99, 1.01))
    left = roomy_rings(two, near, two_pairs(body))
    assert {ring.cut.part for ring in left} == {ring.cut.part for ring in rings} - {1}
    assert len(roomy_rings(two, far, two_pairs(body))) == len(rings)
