"""Parts move by their cores: skin that bends does not pull, and a part without a core moves as before."""

import numpy as np
from articulated import chain, swings
from limbs import rotation
from shipped import TREE
from smeared import moving

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.part_motion import fit, residuals
from kinetree.tasks.numerics.structure.rigid_cores import RigidCoresSettings, core_motions
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints

FRAMES = 12
R_TRUE = np.stack([rotation((0.0, 0.0, 1.0), 0.1 * f) @ rotation((1.0, 0.0, 0.0), 0.07 * f) for f in range(FRAMES)])
T_TRUE = np.stack([[0.3 * f, -0.1 * f, 2.0] for f in range(FRAMES)])


def bent(core: float, scale: float = 1.0) -> tuple[Floats, Floats]:
    """V (vertex, xyz) · x (frame, vertex, xyz) of a bar whose skin beyond a share of its length lags behind its motion."""
    V = np.random.default_rng(0).uniform((-5.0, -1.0, -1.0), (5.0, 1.0, 1.0), (400, 3)) + 20.0
    behind = np.clip((V[:, 0] - 15.0) / 10.0 - core, 0.0, None)
    held = np.einsum("txy,vy->tvx", R_TRUE, V) + T_TRUE[:, None]
    rest = np.einsum("txy,vy->tvx", R_TRUE @ rotation((0.0, 1.0, 0.0), 0.5), V - 20.0) + held.mean(axis=1, keepdims=True)
    return scale * V, scale * (held + behind[:, None] * (rest - held) * np.sin(np.arange(FRAMES))[:, None, None])


def wavy(count: int, seed: int) -> tuple[Floats, Floats]:
    """V (vertex, xyz) · x (frame, vertex, xyz) of a bar of so many vertices that waves pass through everywhere."""
    rng = np.random.default_rng(seed)
    V = rng.uniform((-5.0, -1.0, -1.0), (5.0, 1.0, 1.0), (count, 3))
    x = np.repeat(V[None], FRAMES, axis=0)
    for _ in range(4):
        wave = np.sin(V @ rng.normal(0.0, 0.9, 3) + rng.uniform(0.0, 2.0 * np.pi))
        x += wave[:, None] * rng.normal(0.0, 0.15, (FRAMES, 1, 3))
    return V, np.einsum("txy,tvy->tvx", R_TRUE, x) + T_TRUE[:, None]


def moved(V: Floats, x: Floats, settings: RigidCoresSettings | None = None) -> tuple[tuple[Floats, ...], tuple[Floats, ...]]:
    """Motion and residual of the bar as one part, as it is fitted at first and by its core."""
    label, ones, area = np.zeros(len(V), np.int64), np.ones(x.shape[:2]), np.full(len(V), 0.1 * np.ptp(V) ** 2)
    R, t = np.zeros((FRAMES, 1, 3, 3)), np.zeros((FRAMES, 1, 3))
    fit(V, x, ones, area, label, np.ones(1, np.bool_), False, len(V), 1e-12, R, t)
    first = R, t, residuals(V, x, ones * area, R, t, label)
    return first, core_motions(V, x, area, label, *first, settings)


def taken(V: Floats, x: Floats, settings: RigidCoresSettings | None = None) -> bool:
    """Whether the bar moves by a core."""
    before, after = moved(V, x, settings)
    return not np.array_equal(before[0], after[0])


def carried_off(V: Floats, motion: tuple[Floats, ...]) -> float:
    """The largest distance between where a motion and the true one carry a vertex."""
    R, t = motion[0][:, 0], motion[1][:, 0]
    apart = np.einsum("txy,vy->tvx", R - R_TRUE, V) + (t - T_TRUE)[:, None]
    return float(np.linalg.norm(apart, axis=2).max())


def test_a_part_moves_exactly_as_the_third_of_it_that_does_not_bend() -> None:
    V, x = bent(0.35)
    before, after = moved(V, x)
    assert carried_off(V, before) > 0.02
    assert carried_off(V, after) < 1e-4
    assert after[2].max() < 1e-4 < before[2].max()


def test_a_part_that_bends_everywhere_moves_as_before() -> None:
    V, x = bent(0.35)
    x = x + np.random.default_rng(1).normal(0.0, 0.5, x.shape)
    before, after = moved(V, x)
    for one, other in zip(before, after, strict=True):
        np.testing.assert_array_equal(one, other)


def test_noise_on_a_rigid_part_moves_it_no_farther_than_the_first_fit_by_much() -> None:
    V, x = bent(1.0)
    x = x + np.random.default_rng(2).normal(0.0, 0.05, x.shape)
    before, after = moved(V, x, RigidCoresSettings(clearer=np.inf))
    assert carried_off(V, after) < 2.0 * carried_off(V, before)


def test_a_part_of_few_vertices_moves_as_before() -> None:
    V, x = bent(0.35)
    before, after = moved(V, x, RigidCoresSettings(least_vertices=len(V) + 1))
    np.testing.assert_array_equal(before[0], after[0])


def test_a_few_vertices_that_some_motion_explains_are_no_core() -> None:
    bars, without = [wavy(12, seed) for seed in range(10)], RigidCoresSettings(least_alike=0.0)
    assert not any(taken(*bar) for bar in bars)
    assert sum(taken(*bar, without) for bar in bars) >= 3


def test_a_part_without_area_moves_as_before() -> None:
    V, x = bent(0.35)
    label = (np.arange(len(V)) % 2).astype(np.int64)
    still = np.tile(np.eye(3), (FRAMES, 2, 1, 1)), np.zeros((FRAMES, 2, 3)), np.ones((FRAMES, 2))
    after = core_motions(V, x, np.where(label == 1, 0.0, 1.0), label, *still)
    changed = [(one != other).reshape(FRAMES, 2, -1).any(axis=(0, 2)).tolist() for one, other in zip(still, after, strict=True)]
    assert changed == [[True, False]] * 3


def test_parts_of_a_tree_whose_skin_bends_about_the_joint_move_by_their_cores() -> None:
    body = chain((0.0,), swings(16, 2, 40.0), blend=4.0)
    ones, (R, t) = np.ones(body.x.shape[:2]), (np.zeros_like(body.R), np.zeros_like(body.t))
    fit(body.V, body.x, ones, body.area, body.label, np.ones(2, np.bool_), False, len(body.V), 1e-12, R, t)
    left = residuals(body.V, body.x, ones * body.area, R, t, body.label)
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    tree = tree_joints(moving(body), Cut(body.V, body.label, R, t, left), tips, settings=TREE)
    order = tree.left.part_tree.tree.order
    before, after = (np.abs(motion - body.R[:, order]).max() for motion in (R[:, order], tree.R))
    assert after < 0.2 * before
    np.testing.assert_allclose(tree.rest[1], body.joints[1], atol=0.05)


def test_the_same_on_a_body_of_another_size() -> None:
    one, other = moved(*bent(0.35))[1], moved(*bent(0.35, 40.0))[1]
    np.testing.assert_allclose(one[0], other[0], atol=1e-4)
    np.testing.assert_allclose(40.0 * one[1], other[1], atol=0.05)
