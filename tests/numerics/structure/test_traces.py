"""Laws of what is kept of the structure: merge errors, the graph of parts, which parts stayed, lengths before they are held."""

import numpy as np
import pytest
from articulated import chain, swings, three_arms
from limbs import rotation

from kinetree.tasks.numerics.geometry.rigid_fit import moments
from kinetree.tasks.numerics.structure.joint_rotations import turning_range
from kinetree.tasks.numerics.structure.optimal_runs import runs
from kinetree.tasks.numerics.structure.part_tree import Carried, Surfaces
from kinetree.tasks.numerics.structure.traces import (
    ConesTraced,
    bone_lengths,
    growth,
    most,
    parts_graph,
    survivors,
    traced_cones,
)

BENT = chain((0.0,), swings(12, 2))


def traced(V=BENT.V, x=BENT.x, F=BENT.F, trust=None, tips=None, count=20) -> ConesTraced:
    tip = np.array([int(V[:, 2].argmin())]) if tips is None else tips
    return traced_cones(V, F, x, trust, tip, count, 0.002)


def best_fit(q: np.ndarray, x: np.ndarray) -> float:
    """Σ |R q + t − x|² of the best rigid motion, by singular values."""
    a, b = q - q.mean(axis=0), x - x.mean(axis=0)
    U, S, Vt = np.linalg.svd(a.T @ b)
    S[-1] *= np.sign(np.linalg.det(U @ Vt))
    return float((a**2).sum() + (b**2).sum() - 2 * S.sum())


def test_rings_merge_worst_where_the_body_bends():
    found = traced()
    rings = int((found.run[0] >= 0).sum())
    heights = [BENT.V[found.ring[0] == k, 2].max() for k in range(rings)]
    # sums of rings go over ends and bend alike; a bend is where two stiff halves meet
    assert abs(heights[int(np.nanargmax(found.merge[0]))]) < 0.4
    assert np.nanmax(found.merge[0]) > 0.01
    assert np.isnan(found.merge[0, rings - 1 :]).all()
    cut = np.flatnonzero(np.diff(found.run[0, :rings]))
    assert np.abs(np.array(heights)[cut]).min() < 0.4


def test_stiff_bodies_have_no_merge_error():
    found = traced(x=np.stack([BENT.V @ rotation((1.0, 2.0, 3.0), a).T + a for a in (0.0, 1.0, 2.0)]))
    assert np.nanmax(found.merge) < 1e-6
    assert found.run.max() == 0


def test_merge_errors_have_no_unit_and_do_not_see_where_the_body_is():
    turn = rotation((1.0, 1.0, 0.0), 0.7)
    one, other = traced(), traced(V=7 * BENT.V, x=7 * BENT.x @ turn.T + 100)
    np.testing.assert_array_equal(one.run, other.run)
    np.testing.assert_allclose(one.merge, other.merge, atol=1e-7)


def test_growth_is_the_difference_of_best_fits():
    ring = np.digitize(BENT.V[:, 2], [-3, -1, 1, 3])
    M = moments(BENT.V, BENT.x, np.ones(BENT.x.shape[:2]), ring, 5)
    for k, grown in enumerate(growth(M, 2)):
        one, other = (ring <= k) & (ring > k - 2), (ring > k) & (ring <= k + 2)
        told = sum(
            best_fit(BENT.V[one | other], x[one | other]) - best_fit(BENT.V[one], x[one]) - best_fit(BENT.V[other], x[other])
            for x in BENT.x
        )
        assert grown == pytest.approx(told, rel=1e-6)


def test_two_tenths_are_cut_where_their_merge_error_is_above_the_threshold():
    ring = np.digitize(BENT.V[:, 2], np.linspace(-2, 2, 9))
    M = moments(BENT.V, BENT.x, np.ones(BENT.x.shape[:2]), ring, 10)
    mass = len(BENT.x) * float(np.median(M[:, :, 0].mean(axis=1))) * 50 / 5
    error = np.sqrt(growth(M, 5)[4] / mass)
    assert runs(M, mass * (0.99 * error) ** 2, 2)[-1] == 1
    assert runs(M, mass * (1.01 * error) ** 2, 2)[-1] == 0


def test_no_tips_leave_empty_arrays_and_a_tip_elsewhere_an_empty_cone():
    none = traced(tips=np.zeros(0, np.int64))
    assert (none.ring.shape, none.merge.shape) == ((0, len(BENT.V)), (0, 20))
    V, F = (
        np.concatenate([BENT.V, [[9, 9, 9], [9, 9, 10], [9, 10, 9]]]),
        np.concatenate([BENT.F, len(BENT.V) + np.arange(3)[None]]),
    )
    x = np.concatenate([BENT.x, np.broadcast_to(V[-3:], (len(BENT.x), 3, 3))], axis=1)
    found = traced(V, x, F, tips=np.array([len(V) - 1, int(V[:, 2].argmin())]))
    assert (found.ring[0] == -1).all()
    assert np.isnan(found.merge[0]).all()
    assert (found.ring[1, :-3] >= 0).all()
    assert (found.ring[1, -3:] == -1).all()


def test_vertices_of_two_cones_belong_to_neither():
    ring = np.array([[0, 1, 1, -1], [-1, 0, -1, 0]])
    found = ConesTraced(ring, ring, np.zeros((2, 4)))
    np.testing.assert_array_equal(found.own, [[0, -1, 1, -1], [-1, -1, -1, 0]])


def test_a_ring_is_of_the_label_that_has_most_of_it():
    ring, area = np.array([[0, 0, 0, 2, -1]]), np.array([1.0, 1.0, 3.0, 1.0, 9.0])
    np.testing.assert_array_equal(most(ring, np.array([4, 4, 2, 1, 0]), area, 4), [[2, -1, 1, -1]])


def test_a_tree_of_parts_keeps_all_its_borders():
    body = three_arms()
    graph = parts_graph(Surfaces(body.V, body.F, body.x, body.area), Carried(body.label, body.R, body.t, body.residual))
    np.testing.assert_array_equal(graph.pair, [[0, 1], [0, 2], [0, 3]])
    assert graph.kept.all()
    assert np.linalg.norm(graph.rest - body.joints[1:], axis=1).max() < 1.0
    turned = [turning_range(body.R[:, 0].transpose(0, 2, 1) @ body.R[:, k]) for k in (1, 2, 3)]
    assert graph.degrees == pytest.approx(turned)


def test_a_ring_of_parts_loses_its_worst_border():
    body = three_arms()
    middle = body.label == 0
    around = np.where(middle, (body.V @ body.joints[1:].T).argmax(axis=1), body.label - 1)
    t = body.t[:, 1:].copy()
    t[:, 2] += np.array([3.0, 1.0, 0.0])[:, None].T * np.sin(np.arange(len(t)))[:, None]
    carried = Carried(around, body.R[:, 1:], t, body.residual[:, 1:])
    graph = parts_graph(Surfaces(body.V, body.F, body.x, body.area), carried)
    np.testing.assert_array_equal(graph.pair, [[0, 1], [0, 2], [1, 2]])
    assert graph.kept.sum() == 2
    assert graph.kept[0]


def test_parts_that_no_joint_carries_were_dropped():
    body = three_arms()
    label = body.label.copy()
    outer = (label == 1) & (body.V @ body.joints[1] > 18 * 12)
    label[outer] = 4
    slid = body.R[:, 1] @ np.stack([rotation((0.0, 0.0, 1.0), 0.05 * np.sin(f)) for f in range(len(body.R))])
    R, t = np.concatenate([body.R, slid[:, None]], axis=1), np.concatenate([body.t, body.t[:, 1:2]], axis=1)
    parts = Carried(label, R, t, np.zeros(R.shape[:2]))
    joints = np.array([0, 5, 3, 1])
    back = [0, 3, 2, 1]
    assert survivors(body.V, body.area, parts, joints, body.R[:, back], body.t[:, back]).tolist() == [0, 1, 3, 5, -1]


def test_bones_of_rigid_parts_that_share_joints_have_one_length():
    body = chain((-1.0, 2.0), swings(10, 3))
    rest, parents = np.concatenate([body.joints, [[0.0, 0.0, 5.0]]]), np.array([-1, 0, 1, 2])
    length = bone_lengths(rest, parents, np.array([0, 1, 2, -1]), body.R, body.t)
    assert length == pytest.approx(np.broadcast_to([0.0, 1.5, 3.0, 3.0], (10, 4)))


def test_a_joint_lies_half_way_between_where_its_parts_have_it():
    body = chain((-1.0, 2.0), np.tile(np.eye(3), (4, 3, 1, 1)))
    t = body.t.copy()
    t[2, 2, 2] += 0.5
    length = bone_lengths(body.joints, np.array([-1, 0, 1]), np.arange(3), body.R, t)
    assert length[:, 2] == pytest.approx([3.0, 3.0, 3.25, 3.0])
    assert length[:, 1] == pytest.approx(np.full(4, 1.5))
