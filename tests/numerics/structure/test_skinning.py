"""Skinning weights."""

import numpy as np
import pytest
from articulated import chain

from kinetree.tasks.numerics.structure.skinning import candidates, few, heaviest, skinning


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
