"""Laws of unfolding one triangle before a virtual source, in the plane where all is known."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics import unfolding as u

Floats = npt.NDArray[np.float64]


def block_of(source: Floats, third: Floats, base: float) -> Floats:
    """A block whose entry i has its edge from (0, 0) to (base, 0), its source below and its third vertex above."""
    W = np.zeros(u.ROWS * u.BLOCK)
    ends = np.array([[0.0, 0.0], [base, 0.0]])
    rows = {
        u.NEAR: np.linalg.norm(source - ends[0], axis=1),
        u.OTHER: np.linalg.norm(source - ends[1], axis=1),
        u.BASE: np.full(len(source), base),
        u.SIDE: np.linalg.norm(third - ends[0], axis=1),
        u.RIM: np.linalg.norm(third - ends[1], axis=1),
        u.SIGMA: np.full(len(source), 3.0),
    }
    for row, values in rows.items():
        W[int(row) : int(row) + len(source)] = values
    u.unfold_first(np.uint64(len(source)), W)
    return W


def row(W: Floats, at: np.uint64, count: int) -> Floats:
    return W[int(at) : int(at) + count]


def test_the_third_vertex_is_as_far_as_its_straight_line_beyond_the_bend() -> None:
    rng = np.random.default_rng(0)
    source, third = rng.uniform([-3, -4], [5, -0.1], (200, 2)), rng.uniform([-3, 0.1], [5, 4], (200, 2))
    W = block_of(source, third, 2.0)
    assert np.allclose(row(W, u.REACH, 200), 3.0 + np.linalg.norm(third - source, axis=1))


def test_a_line_is_seen_to_miss_the_edge_on_the_side_where_it_misses() -> None:
    rng = np.random.default_rng(1)
    source, third = rng.uniform([-3, -4], [5, -0.1], (200, 2)), rng.uniform([-3, 0.1], [5, 4], (200, 2))
    W = block_of(source, third, 2.0)
    crossing = source[:, 0] - source[:, 1] * (third - source)[:, 0] / (third - source)[:, 1]
    assert np.array_equal(row(W, u.FROM_LEFT, 200) < 0, crossing < 0)
    assert np.array_equal(row(W, u.FROM_RIGHT, 200) < 0, crossing > 2.0)
    assert 20 < (crossing < 0).sum() < 180


def test_distances_that_no_point_has_give_no_virtual_source() -> None:
    W = np.zeros(u.ROWS * u.BLOCK)
    for at, value in ((u.NEAR, 1.0), (u.OTHER, 4.0), (u.BASE, 2.0), (u.SIDE, 2.0), (u.RIM, 2.0)):
        W[int(at)] = value
    u.unfold_first(np.uint64(1), W)
    assert row(W, u.Y, 1) == 0
