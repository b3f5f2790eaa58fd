"""Laws of fitting motions to parts."""

import numpy as np
from limbs import rotation

from kinetree.tasks.numerics.structure.part_motion import fit, median_of, members, misfit, residuals, unevenness


def two_clouds():
    """Two clouds that turn differently, one tenth of the second's vertices labelled as the first's."""
    rng = np.random.default_rng(0)
    V = rng.normal(size=(200, 3))
    true = np.repeat([0, 1], 100)
    R = np.stack([np.stack([rotation((0, 0, 1), 0.2 * t), rotation((1, 0, 0), -0.3 * t)]) for t in range(4)])
    x = np.einsum("tvij,vj->tvi", R[:, true], V)
    label = true.copy()
    label[100:110] = 0
    return V, x, R, true, label


def fitted(V, x, label, warm=None, most=1000):
    R, t = np.zeros((len(x), 2, 3, 3)), np.zeros((len(x), 2, 3))
    if warm is not None:
        R[:] = warm
    ones = np.ones(x.shape[:2])
    fit(V, x, ones, np.ones(len(V)), label, np.ones(2, bool), warm is not None, most, 1e-10, R, t)
    return R, t


def test_vertices_that_move_otherwise_do_not_pull():
    V, x, R, _, label = two_clouds()
    found, t = fitted(V, x, label)
    np.testing.assert_allclose(found, R, atol=1e-4)
    np.testing.assert_allclose(t, 0.0, atol=1e-4)


def test_a_part_that_inherits_a_majority_stays_with_what_it_explained():
    V, x, R, _, _ = two_clouds()
    label = np.zeros(200, np.int64)
    label[:60] = 1
    found, _ = fitted(V, x, label, warm=R[:, ::-1])
    np.testing.assert_allclose(found[:, 0], R[:, 1], atol=1e-3)


def test_a_few_vertices_fit_as_well_as_all():
    V, x, R, true, _ = two_clouds()
    np.testing.assert_allclose(fitted(V, x, true, most=30)[0], R, atol=1e-9)


def test_misfit_and_residuals_are_what_is_left():
    V, x, R, true, label = two_clouds()
    t, ones = np.zeros((4, 2, 3)), np.ones(x.shape[:2])
    e = misfit(V, x, ones, R, t, label)
    assert e[label == true].max() < 1e-20
    square = ((V[100:110] @ np.swapaxes(R[:, 0], 1, 2) - x[:, 100:110]) ** 2).sum(axis=2)
    np.testing.assert_allclose(e[100:110], square.mean(axis=0))
    np.testing.assert_allclose(residuals(V, x, ones, R, t, label)[:, 0], np.sqrt(square.sum(axis=1) / 110))


def test_noise_of_vertices_cancels_in_patches_and_a_stray_patch_does_not():
    V, x, R, true, _ = two_clouds()
    t, patch = np.zeros((4, 2, 3)), np.arange(200) // 50
    noisy = x + 0.1 * np.random.default_rng(1).normal(size=x.shape)
    noisy[:, patch == 3] += [0.0, 0.0, 0.2]
    stray = unevenness(V, noisy, np.ones(200), patch, true, R, t)
    assert stray[:3].max() < 0.04
    np.testing.assert_allclose(stray[3], 0.2, atol=0.03)


def test_the_median_is_the_median():
    values = np.random.default_rng(3).random(101)
    np.testing.assert_allclose(median_of(values, 101), np.median(values), atol=1e-9)
    assert median_of(np.zeros(5), 5) == 0.0


def test_of_too_many_members_evenly_many_are_taken():
    out = np.empty(100, np.int64)
    count = members(np.arange(100) % 2, 1, 10, out)
    np.testing.assert_array_equal(out[:count], np.arange(1, 100, 10))
