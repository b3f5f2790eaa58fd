"""Laws of the optimal cut of a chain of rings."""

import numpy as np
from limbs import bent, tube

from kinetree.tasks.numerics.geometry.rigid_fit import moments
from kinetree.tasks.numerics.structure.optimal_runs import runs
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
