"""Laws of clusters: Eq. 5 on motions whose correlation is known, and parts of a body that bends at a joint."""

import numpy as np
import pytest
from articulated import chain

from kinetree.tasks.numerics.paper_2009.node_clusters import (
    correlated_clusters,
    part_motions,
    rigid_clusters,
    velocity_correlation,
)

PAIR = np.array([[0, 1], [0, 2]])


def moving(walk: float) -> np.ndarray:
    """(frame, node, xyz) two nodes that swing alike and one the other way, all walking along."""
    t = np.linspace(0, 2 * np.pi, 40)
    swing = np.stack([np.sin(t), np.sin(t), -np.sin(t)], axis=1)
    step = walk * np.cumsum(1.0 + 0.5 * np.sin(0.5 * t))
    return np.stack([np.tile(step[:, None], 3), swing, 0 * swing], axis=2)


def test_nodes_that_move_alike_have_one_and_opposite_ones_minus_one() -> None:
    r = velocity_correlation(moving(0.0), PAIR, relative=False)
    assert np.allclose(r, [1.0, -1.0])


def test_walking_hides_the_difference_unless_it_is_taken_out() -> None:
    X = moving(3.0)
    assert velocity_correlation(X, PAIR, relative=False)[1] > 0.5
    assert velocity_correlation(X, PAIR, relative=True)[1] < -0.9


def test_letter_divides_by_one_too_few() -> None:
    X = moving(1.0)
    assert velocity_correlation(X, PAIR, relative=False, one_too_few=True)[1] != pytest.approx(
        velocity_correlation(X, PAIR, relative=False)[1], abs=1e-6
    )


def test_clusters_end_where_velocities_do_not_correlate() -> None:
    assert correlated_clusters(np.arange(5) - 1, np.array([0.95, 0.2, 0.99, 0.99]), 0.9).tolist() == [0, 0, 1, 1, 1]


def test_bands_of_a_tube_become_the_parts_on_both_sides_of_its_joint() -> None:
    body = chain((0.0,))
    band = np.clip(body.V[:, 2] + 5.0, 0.0, 9.9).astype(np.int64)
    part = rigid_clusters(body.V, body.F, body.x, np.ones(body.x.shape[:2]), body.area, band, 0.005)
    assert len(np.unique(part)) == 2
    assert min((part == body.label).mean(), (part != body.label).mean()) < 0.08


def test_motions_of_true_parts_are_theirs() -> None:
    body = chain((0.0,))
    motions = part_motions(body.V, body.x, np.ones(body.x.shape[:2]), body.area, body.label, 0.005)
    assert np.allclose(motions.R, body.R, atol=2e-3)
    assert motions.residual.max() < 0.01  # vertices at the joint itself follow both
