"""The body in one frame, and how it answers to small rotations."""

import numpy as np
import pytest
from articulated import chain, swings
from fitting import arms, true
from limbs import rotation

from kinetree.tasks.numerics.structure.articulated_fit import rotations
from kinetree.tasks.numerics.structure.articulated_frame import (
    FramePose,
    SkinnedBody,
    add_equations,
    chained,
    joints,
    limbs,
    relative_rotations,
    surface,
)


def bent_chain() -> tuple[SkinnedBody, FramePose]:
    known = chain((-2.0, 1.0), swings(4, 3), blend=1.5)
    order = np.argsort(-known.W, axis=1)
    bound = np.pad(order, ((0, 0), (0, 1)))
    weight = np.pad(np.take_along_axis(known.W, order, axis=1), ((0, 0), (0, 1)))
    return SkinnedBody.of(known.V, known.F, bound, weight, known.joints, known.parents), true(known, 2)


def test_surface_goes_where_the_motion_carries_it() -> None:
    known, body = arms()
    for frame in (0, 5):
        x, n = surface(body, true(known, frame))
        assert x == pytest.approx(known.x[frame], abs=1e-9)
        assert np.linalg.norm(n, axis=1) == pytest.approx(np.ones(len(n)))


def test_turns_against_parents_give_the_rotations_back() -> None:
    body, at = bent_chain()
    assert chained(relative_rotations(at.R, body.parents), body.parents) == pytest.approx(at.R)


@pytest.mark.parametrize(("plane", "point"), [(1.0, 0.0), (0.0, 1.0), (0.7, 0.2)])
def test_normal_equations_are_those_of_small_turns(plane: float, point: float) -> None:
    body, at = bent_chain()
    rng = np.random.default_rng(3)
    vertex = rng.integers(0, len(body.V), 40)
    d, n = rng.normal(0, 0.1, (40, 3)), rng.normal(0, 1, (40, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    m = 3 * len(body.parents) + 3
    H, g = np.zeros((m, m)), np.zeros(m)
    weights = np.full(40, plane), np.full(40, point)
    skin = (body.V, body.bound, body.weight, body.rest, body.parents)
    add_equations(H, g, vertex, d, n, *weights, *skin, at.R, joints(body, at))
    H[-3:, :-3] = H[:-3, -3:].T
    step, x = 1e-6, surface(body, at)[0][vertex]
    J = np.empty((m, 40, 3))
    for k in range(m):
        move = np.eye(m)[k] * step
        other = FramePose(rotations(move[:-3].reshape(-1, 3)) @ at.R, at.x + move[-3:])
        J[k] = (surface(body, other)[0][vertex] - x) / step
    across = np.einsum("kvx,vx->kv", J, n)
    assert g == pytest.approx(plane * across @ (n * d).sum(axis=1) + point * np.einsum("kvx,vx->k", J, d), abs=1e-4)
    assert np.abs(H - plane * across @ across.T - point * np.einsum("kvx,mvx->km", J, J)).max() < 1e-3


def test_doubted_parts_that_are_joined_are_one_limb() -> None:
    parents = np.array([-1, 0, 1, 2, 0, 4])
    assert limbs(parents, np.array([False, True, True, False, False, True])).tolist() == [-1, 0, 0, -1, -1, 1]
    assert limbs(parents, np.ones(6, bool)).tolist() == [0] * 6
    assert rotation((0.0, 0.0, 1.0), 0.0) == pytest.approx(np.eye(3))
