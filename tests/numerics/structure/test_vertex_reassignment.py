"""Vertices of a part that is gone."""

import numpy as np
from articulated import chain

from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.structure.vertex_reassignment import reassigned


def test_vertices_go_to_the_part_that_moves_most_like_them() -> None:
    body = chain((0.1,))
    between = body.label.copy()
    between[np.abs(body.V[:, 2]) < 1.5] = 2
    R, t = (np.concatenate([a, a[:, :1]], axis=1) for a in (body.R, body.t))
    start, ring = rings(body.F, len(body.V))
    assert reassigned(body.V, body.x, between, 2, R, t, start, ring).tolist() == body.label.tolist()


def test_a_part_takes_only_what_it_reaches() -> None:
    body = chain((-2.0, 2.0))
    start, ring = rings(body.F, len(body.V))
    R, t = body.R.copy(), body.t.copy()
    given = reassigned(body.V, body.x, body.label, 2, R, t, start, ring)
    assert set(given[body.label == 2]) == {1}
