"""Skinning weights."""

import numpy as np
import pytest
from articulated import chain

from kinetree.tasks.numerics.structure.skinning import candidates, few, heaviest, on_simplex, skinning


def test_weights_of_a_skinned_body_come_back() -> None:
    body = chain((-1.5, 1.5), blend=1.5)
    found = skinning(body.V, body.F, body.x, body.label, body.R, body.t, body.parents, np.ones(body.x.shape[:2]), 1e-3)
    assert found == pytest.approx(body.W, abs=0.02)
    assert found.sum(axis=1) == pytest.approx(1)
    assert found.min() >= 0


def test_vertices_that_were_not_seen_follow_those_around() -> None:
    body = chain((0.0,), blend=1.5)
    tau = np.ones(body.x.shape[:2])
    hidden = np.arange(len(body.V)) % 7 == 0
    tau[:, hidden] = 0.0
    x = body.x.copy()
    x[:, hidden] = 100.0
    found = skinning(body.V, body.F, x, body.label, body.R, body.t, body.parents, tau, 1e-3)
    assert found[~hidden] == pytest.approx(body.W[~hidden], abs=0.03)
    assert np.abs(found[hidden] - body.W[hidden]).max() < 0.25


def test_weights_do_not_depend_on_how_many_neighbours_other_parts_have() -> None:
    body, more = chain((-1.5, 1.5), blend=1.5), 5
    alone = skinning(body.V, body.F, body.x, body.label, body.R, body.t, body.parents, np.ones(body.x.shape[:2]), 0.3)
    R, t = (np.concatenate([a, np.repeat(a[:, 1:2], more, axis=1)], axis=1) for a in (body.R, body.t))
    parents = np.append(body.parents, np.full(more, 1))
    beside = skinning(body.V, body.F, body.x, body.label, R, t, parents, np.ones(body.x.shape[:2]), 0.3)
    ends = np.isin(body.label, (0, 2))
    assert beside[ends, :3] == pytest.approx(alone[ends], abs=1e-9)


def test_at_most_four_parts_move_a_vertex() -> None:
    W = np.array([[0.3, 0.2, 0.15, 0.15, 0.1, 0.1], [0.995, 0.005, 0, 0, 0, 0]])
    kept = few(W)
    assert (kept > 0).sum(axis=1).tolist() == [4, 1]
    assert kept.sum(axis=1) == pytest.approx([1, 1])
    part, weight = heaviest(kept)
    assert part.tolist() == [[0, 1, 2, 3], [0, 0, 0, 0]]
    assert (np.diff(weight, axis=1) <= 0).all()


def test_bodies_of_fewer_than_four_parts_have_empty_places() -> None:
    part, weight = heaviest(np.array([[0.25, 0.75]]))
    assert (part.tolist(), weight.tolist()) == ([[1, 0, 0, 0]], [[0.75, 0.25, 0, 0]])


def test_neighbours_in_the_tree_are_candidates() -> None:
    assert candidates(np.array([0]), np.array([-1, 0, 0])).tolist() == [[0, 1, 2], [1, 0, -1], [2, 0, -1]]


def test_no_weight_goes_to_a_candidate_that_is_not_there() -> None:
    H, g = np.zeros((1, 3, 3)), np.array([[0.0, 0.2, 0.0]])
    H[0, 1, 1] = 1.0
    around, hold = np.array([[0.0, 1.0, 0.0]]), np.array([1e-9])
    assert on_simplex(H, g, hold, around, np.array([2])) == pytest.approx(np.array([[0.8, 0.2, 0.0]]), abs=1e-3)
