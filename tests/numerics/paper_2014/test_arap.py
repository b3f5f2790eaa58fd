"""Laws of as-rigid-as-possible deformation with soft constraints."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from limbs import LENGTH, RADIUS, bent, rotation, tube
from shapes import sphere, two_components

from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.paper_2014.arap import Factorised, soft_weights

V, F = tube(20, 40)
AREA = Surface.of(V, F).area
SOFT = Factorised.of(V, F, soft_weights(AREA, RADIUS))
NOISE = np.random.default_rng(2).normal(size=V.shape)


@pytest.mark.parametrize("angle", [0.3, 3.0])
def test_rigid_motion_is_reproduced_to_a_ten_billionth(angle):
    moved = V @ rotation((1, 2, 3), angle).T + np.array([4.0, -2.0, 1.0])
    deformed = SOFT.solve(moved)
    np.testing.assert_allclose(deformed.x, moved, atol=1e-10 * LENGTH)
    np.testing.assert_allclose(deformed.rotation, np.tile(rotation((1, 2, 3), angle), (len(V), 1, 1)), atol=1e-10)
    assert deformed.energy[-1] < 1e-15


@pytest.mark.parametrize("start", [None, V, NOISE])
def test_energy_never_rises(start):
    deformed = SOFT.solve(bent(V, 1.5) + 0.3 * NOISE, start, steps=60, tolerance=0.0)
    assert len(deformed.energy) == 61
    assert (np.diff(deformed.energy) <= 1e-12 * deformed.energy[0]).all()
    assert deformed.energy[-1] < deformed.energy[0]


def test_zero_weight_leaves_the_rest_state():
    free = Factorised.of(V, F, np.zeros(len(V)))
    np.testing.assert_allclose(free.solve(NOISE).x, V, atol=1e-10 * LENGTH)
    crumpled = V + 0.02 * NOISE
    deformed = free.solve(NOISE, crumpled, steps=400, tolerance=0.0)
    assert deformed.energy[-1] < 0.01 * deformed.energy[0], "from elsewhere it goes back to its shape"


def test_piece_without_constraints_stays_and_does_not_disturb_the_other():
    both, faces = two_components(2)
    half = len(both) // 2
    soft = np.where(np.arange(len(both)) < half, 0.1, 0.0)
    wanted = both + np.array([1.0, 2.0, 3.0])
    deformed = Factorised.of(both, faces, soft).solve(wanted)
    np.testing.assert_allclose(deformed.x[:half], wanted[:half], atol=1e-9)
    np.testing.assert_allclose(deformed.x[half:], both[half:], atol=1e-9)


def test_scale_and_place_do_not_matter():
    wanted = bent(V, 1.0) + 0.1 * NOISE
    deformed = SOFT.solve(wanted)
    turn = rotation((0, 1, 1), 0.7)
    larger = Factorised.of(100.0 * V, F, soft_weights(10_000.0 * AREA, 100.0 * RADIUS))
    np.testing.assert_allclose(larger.solve(100.0 * wanted @ turn.T + 50.0).x, 100.0 * deformed.x @ turn.T + 50.0, atol=1e-6)


def test_what_errs_over_less_than_the_length_is_averaged():
    true = bent(V, 0.8)
    deformed = SOFT.solve(true + 0.1 * NOISE)
    wrong = np.linalg.norm(deformed.x - true, axis=1).mean()
    assert wrong < 0.5 * np.linalg.norm(0.1 * NOISE, axis=1).mean()


def test_the_heavier_the_nearer():
    wanted = bent(V, 1.5) + 0.2 * NOISE
    distance = [
        np.linalg.norm(Factorised.of(V, F, soft_weights(AREA, length)).solve(wanted).x - wanted, axis=1).mean()
        for length in (4.0, 1.0, 0.1, 0.001)
    ]
    assert (np.diff(distance) < 0).all()
    assert distance[-1] < 1e-4


def test_many_frames_at_once_share_one_factorisation_bit_by_bit():
    frames = [bent(V, angle) + 0.1 * NOISE for angle in np.linspace(-1, 1, 8)]
    alone = [SOFT.solve(q).x for q in frames]
    with ThreadPoolExecutor(4) as pool:
        for one, other in zip(alone, pool.map(lambda q: SOFT.solve(q).x, frames), strict=True):
            np.testing.assert_array_equal(one, other)


def test_with_large_weights_it_is_the_hard_constrained_arap_of_libigl():
    igl = pytest.importorskip("igl", reason="compares with libigl's ARAP; pip install libigl")
    ball, faces = sphere(3)  # of triangles so even that no weight is clamped
    fixed = np.flatnonzero(np.abs(ball[:, 2]) > 0.6).astype(np.int32)
    wanted = np.where(ball[:, 2:] > 0.6, ball @ rotation((1, 0, 0), 0.9).T + [0.0, 0.0, 1.0], ball)
    soft = np.zeros(len(ball))
    soft[fixed] = 1e7
    steps = 300
    ours = Factorised.of(ball, faces, soft).solve(wanted, ball, steps=steps, tolerance=0.0)
    settings = igl.ARAPData()
    settings.energy = igl.ARAP_ENERGY_TYPE_SPOKES
    settings.max_iter = steps
    igl.arap_precomputation(ball, faces, 3, fixed, settings)
    theirs = igl.arap_solve(wanted[fixed], settings, ball.copy())
    free = np.setdiff1d(np.arange(len(ball)), fixed)
    assert np.abs(theirs[free] - ball[free]).max() > 0.3, "the constraint bends it"
    np.testing.assert_allclose(ours.x, theirs, atol=1e-5)
