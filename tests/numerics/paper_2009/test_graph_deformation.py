"""Laws of the forces: Eqs. 2 to 4 on points whose answer is known, and what the letter of Eq. 4 does."""

import numpy as np
import pytest
from limbs import rotation

from kinetree.tasks.numerics.paper_2009.graph_deformation import (
    Forces,
    along_branches,
    deformed_graph,
    external_forces,
    internal_forces,
    least_turns,
    two_hops,
)

LINE = np.stack([np.arange(6.0), np.zeros(6), np.zeros(6)], axis=1)
CHAIN = np.arange(6) - 1


def test_equal_drifts_move_every_point_by_twice_their_shift() -> None:
    shift = np.array([0.1, 0.2, -0.3])
    P = np.random.default_rng(0).normal(size=(4, 3))
    assert np.allclose(external_forces(P, LINE, LINE + shift, LINE, LINE + shift, 0.5), 2 * shift)


def test_nearest_drift_prevails_within_sigma() -> None:
    target = LINE.copy()
    target[0, 1] = 1.0
    none = np.zeros((0, 3))
    f = external_forces(LINE, LINE, target, none, none, 0.1)
    assert f[0, 1] > 0.99
    assert f[3, 1] < 1e-6


def test_two_hops_of_a_chain() -> None:
    pair, k = two_hops(CHAIN)
    assert {tuple(p) for p in pair[k == 1.0].tolist()} == {(n, n + 1) for n in range(5)}
    assert {tuple(p) for p in pair[k == 0.5].tolist()} == {(n, n + 2) for n in range(4)}


def test_internal_forces_vanish_at_rest_and_pull_to_the_middle_without_rest_lengths() -> None:
    pair, k = two_hops(CHAIN)
    length = np.linalg.norm(LINE[pair[:, 0]] - LINE[pair[:, 1]], axis=1)
    assert np.allclose(internal_forces(LINE, pair, k, length), 0.0)
    f = internal_forces(LINE, pair, k, 0 * length)
    assert f[0, 0] > 0.0 > f[-1, 0]
    assert np.allclose(f.sum(axis=0), 0.0)


def test_model_reaches_a_target_near_it_and_keeps_its_lengths() -> None:
    target = LINE @ rotation((0.0, 0.0, 1.0), 0.05).T
    x = deformed_graph(LINE, CHAIN, LINE.copy(), target, 5.0, Forces(steps=200, anchor=0.0))
    assert np.linalg.norm(x - target, axis=1).max() < 0.08


def test_equation_four_to_the_letter_shortens_the_model() -> None:
    letter = Forces(steps=200, rest_length=False)
    x = deformed_graph(LINE, CHAIN, LINE.copy(), LINE, 5.0, letter)
    assert np.ptp(x[:, 0]) < 0.8 * np.ptp(LINE[:, 0])


@pytest.mark.parametrize("centred", [True, False])
def test_anchor_pulls_to_the_place_before_or_to_the_origin(centred: bool) -> None:
    away = LINE + [0.0, 100.0, 0.0]
    x = deformed_graph(away, CHAIN, away.copy(), away, 5.0, Forces(steps=200, anchor=0.05, centred=centred))
    assert (abs(x[:, 1].mean() - 100.0) < 0.1) == centred


def test_nodes_of_a_branch_are_pulled_to_points_as_far_from_the_leaf() -> None:
    line = [LINE[::-1] + [0.0, 2.0, 0.0]]
    branch = np.array([-1, 0, 0, 0, 0, 0])
    nodes, places = along_branches(LINE, CHAIN, branch, np.array([5]), np.array([0]), line)
    assert nodes.tolist() == [5, 4, 3, 2, 1]
    assert np.allclose(places, LINE[nodes] + [0.0, 2.0, 0.0])


def test_least_turns_follow_a_rotated_chain() -> None:
    R = rotation((0.0, 1.0, 0.0), 0.7)
    turns = least_turns(LINE, CHAIN, np.repeat(np.eye(3)[None], 6, axis=0), LINE @ R.T)
    assert np.allclose(turns[1:] @ [1.0, 0.0, 0.0], R @ [1.0, 0.0, 0.0])
