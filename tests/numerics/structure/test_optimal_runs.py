"""Laws of the optimal cut of a chain of rings."""

import articulated
import numpy as np
from limbs import bent, tube

from kinetree.tasks.numerics.geometry.rigid_fit import moments
from kinetree.tasks.numerics.structure.optimal_runs import merge_growth, runs
from kinetree.tasks.numerics.structure.patch_merging import costs

ANGLES = (0.3, 0.6, 0.9, -0.4)


def chain(angles=ANGLES, count=40):
    V, _ = tube()
    x = np.stack([bent(V, a, 0.01) for a in angles])
    ring = np.minimum(((V[:, 2] + 5) / 10 * count).astype(np.int64), count - 1)
    return moments(V, x, np.ones(x.shape[:2]), ring, count)


def test_a_hinge_cuts_a_chain_in_two_at_the_hinge():
    run = runs(chain(), 1.0, 2)
    np.testing.assert_array_equal(run, np.repeat([0, 1], 20))


def test_what_does_not_bend_is_not_cut():
    assert runs(chain((0.0, 0.0, 0.0, 0.0)), 1e-6, 2).max() == 0


def test_no_other_cut_in_two_costs_less():
    M = chain()
    best = runs(M, 1.0, 2)

    def cost(label):
        return costs(np.stack([M[label == k].sum(axis=0) for k in np.unique(label)])).sum() + len(np.unique(label))

    for j in range(2, 39):
        assert cost(best) <= cost((np.arange(40) >= j).astype(int)) + 1e-9


def test_a_run_has_the_least_number_of_rings_and_a_short_chain_is_one():
    assert np.bincount(runs(chain(), 1e-12, 5)).min() >= 5
    assert runs(chain()[:3], 0.0, 2).max() == 0


def best_fit(q, x):
    """Σ |R q + t − x|² of the best rigid motion, by singular values."""
    a, b = q - q.mean(axis=0), x - x.mean(axis=0)
    U, S, Vt = np.linalg.svd(a.T @ b)
    S[-1] *= np.sign(np.linalg.det(U @ Vt))
    return float((a**2).sum() + (b**2).sum() - 2 * S.sum())


def test_growth_is_the_difference_of_best_fits():
    body = articulated.chain((0.0,), articulated.swings(12, 2))
    V, ring = body.V, np.digitize(body.V[:, 2], [-3, -1, 1, 3])
    M = moments(V, body.x, np.ones(body.x.shape[:2]), ring, 5)
    for k, growth in enumerate(merge_growth(M, 2)):
        one, other = (ring <= k) & (ring > k - 2), (ring > k) & (ring <= k + 2)
        sides = (one | other, one, other)
        both, before, behind = (sum(best_fit(V[side], x[side]) for x in body.x) for side in sides)
        np.testing.assert_allclose(growth, both - before - behind, rtol=1e-6, atol=1e-9)


def test_two_tenths_are_cut_where_their_merge_error_is_above_the_threshold():
    body = articulated.chain((0.0,), articulated.swings(12, 2))
    ring = np.digitize(body.V[:, 2], np.linspace(-2, 2, 9))
    M = moments(body.V, body.x, np.ones(body.x.shape[:2]), ring, 10)
    mass = len(body.x) * float(np.median(M[:, :, 0].mean(axis=1))) * 50 / 5
    error = np.sqrt(merge_growth(M, 5)[4] / mass)
    assert runs(M, mass * (0.99 * error) ** 2, 2)[-1] == 1
    assert runs(M, mass * (1.01 * error) ** 2, 2)[-1] == 0
