"""Parts that have other vertices move as these do; skin and drifts follow."""

import numpy as np
import pytest
from articulated import swings
from trunk import trunk_with_two_joints

from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.refitted_tree import refitted_tree
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence

JOINTS = (-1.0, 1.0)
TRUNK = [0, 1, 2]


@pytest.fixture(name="body")
def a_body() -> MovingSurface:
    return of_cut(JOINTS)[0]


def of_cut(found: tuple[float, float]) -> tuple[MovingSurface, FirstTree]:
    return trunk_with_two_joints(swings(24, 4, 20.0, axes=1, seed=1), JOINTS, found)


def refitted(body: MovingSurface, tree: FirstTree, some: list[int], skinned: MovingSurface | None = None) -> FirstTree:
    evidence = SurfaceEvidence(lambda _: pytest.fail("no surface is asked"), np.ones(body.x.shape[:2]), 0.002)
    return refitted_tree(body, tree, some, evidence, skinned)


def test_parts_move_as_their_vertices_do(body: MovingSurface) -> None:
    """Labels are those of the true parts, motions those of parts that were cut elsewhere."""
    true, off = of_cut(JOINTS)[1], of_cut((-0.4, 1.6))[1]
    tree = off._replace(label=true.label, rest=true.rest)
    after = refitted(body, tree, TRUNK)
    np.testing.assert_allclose(after.R[:, TRUNK], true.R[:, TRUNK], atol=1e-6)
    np.testing.assert_allclose(after.t[:, TRUNK], true.t[:, TRUNK], atol=1e-6)
    assert after.unexplained[:, TRUNK].max() < 1e-6
    assert after.drift[[1, 2]].max() < 1e-6
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)


def test_others_stay_as_they_are(body: MovingSurface) -> None:
    tree = of_cut((-0.4, 1.6))[1]._replace(drift=np.full(8, 0.5))
    after = refitted(body, tree, [1])
    others = [0, *range(2, 8)]
    for name in ("R", "t", "unexplained"):
        np.testing.assert_array_equal(getattr(after, name)[:, others], getattr(tree, name)[:, others])
    np.testing.assert_array_equal(after.label, tree.label)
    assert (after.drift[[0, *range(3, 8)]] == 0.5).all(), "their joints have nothing to do with it"
    assert (after.drift[[1, 2]] != 0.5).all()


def test_skin_may_be_weighed_by_another_motion(body: MovingSurface) -> None:
    tree = of_cut(JOINTS)[1]
    still = body._replace(x=np.broadcast_to(body.V, body.x.shape).copy())
    one, other = refitted(body, tree, TRUNK), refitted(body, tree, TRUNK, still)
    np.testing.assert_array_equal(one.R, other.R)
    assert np.abs(one.W - other.W).max() > 0.1
