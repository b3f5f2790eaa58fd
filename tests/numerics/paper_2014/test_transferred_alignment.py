"""Laws of completed positions."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2014.transferred_alignment import TransferredAlignmentSettings, completed

V, F = tube()


def test_missing_positions_of_a_body_that_moves_rigidly_are_exact():
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    x = V @ turn.T + [1, 2, 3]
    known = x.copy()
    known[:5] = np.nan
    np.testing.assert_allclose(completed(V, known), x, atol=1e-9)
    np.testing.assert_array_equal(completed(V, x), x)


def test_body_without_known_positions_is_as_at_rest():
    np.testing.assert_array_equal(completed(V, np.full_like(V, np.nan)), V)


def test_vertex_follows_as_many_neighbours_as_the_settings_say():
    known = V + 0.1 * np.random.default_rng(0).normal(size=V.shape)
    known[0] = np.nan
    few, many = (completed(V, known, TransferredAlignmentSettings(neighbours=n)) for n in (4, 40))
    assert np.abs(few[0] - many[0]).max() > 1e-3
    np.testing.assert_array_equal(few[1:], many[1:])
