"""Laws of the queue in bands."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics import bands

Queue = dict[str, npt.NDArray[np.generic]]


def queue(vertices: int) -> Queue:
    return {
        "distance": np.full(vertices, np.inf),
        "bend": np.zeros(vertices),
        "band": np.full(vertices, bands.IDLE, np.uint32),
        "waiting": np.zeros((bands.BANDS, 2 * vertices + 2), np.uint32),
        "filled": np.zeros(bands.BANDS, np.uint32),
    }


def offer(q: Queue, value: npt.NDArray[np.float64], exact: float = -1.0) -> int:
    vertex = np.arange(len(value), dtype=np.uint32)
    origin = np.zeros(len(value))
    now = np.uint64(0)
    return int(bands.lower(np.uint64(len(value)), vertex, value, origin, now, 1.0, 1e-9, exact, *q.values()))


def drained(q: Queue, bands_ahead: int) -> list[tuple[int, int]]:
    """(band, vertex) in the order in which they leave the queue."""
    front, left = np.empty(2 * len(q["band"]) + 2, np.uint32), []
    for now in range(bands_ahead):
        size = bands.advance(np.uint64(now), 1.0, q["distance"], q["band"], q["waiting"], q["filled"], front)
        left += [(now, int(v)) for v in front[: int(size)]]
    return left


def test_every_vertex_leaves_in_the_band_of_its_distance_however_far_ahead() -> None:
    value = np.random.default_rng(0).uniform(0, 5 * bands.BANDS, 200)
    q = queue(200)
    assert offer(q, value) == 200
    left = drained(q, 5 * bands.BANDS)
    assert sorted(v for _, v in left) == list(range(200))
    assert all(band == int(value[v]) for band, v in left)


def test_a_vertex_that_comes_nearer_leaves_once_and_earlier() -> None:
    q = queue(3)
    assert offer(q, np.array([9.5, 9.5, 9.5])) == 3
    assert offer(q, np.array([2.5, 9.5, 30.0])) == 0
    assert drained(q, 40) == [(2, 0), (9, 1), (9, 2)]


def test_what_is_exact_is_not_lowered() -> None:
    q = queue(2)
    offer(q, np.array([3.0, 5.0]))
    offer(q, np.array([1.0, 1.0]), exact=4.0)
    assert list(q["distance"]) == [3.0, 1.0]
