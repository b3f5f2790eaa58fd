"""Laws of merging patches that move as one."""

import numpy as np
from limbs import bent, tube

from kinetree.tasks.numerics.geometry.rigid_fit import moments
from kinetree.tasks.numerics.structure.patch_merging import costs, merged


def bands(count=20):
    V, _ = tube()
    x = np.stack([bent(V, a, 0.01) for a in (0.3, 0.7)])
    band = np.minimum(((V[:, 2] + 5) / 10 * count).astype(np.int64), count - 1)
    return moments(V, x, np.ones(x.shape[:2]), band, count), np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)


def test_two_groups_of_a_hinge_are_its_two_sides():
    M, pairs = bands()
    np.testing.assert_array_equal(merged(M, pairs, 2), np.repeat([0, 1], 10))


def test_beyond_the_limit_nothing_is_joined():
    M, pairs = bands()
    group = merged(M, pairs, 1, limit=1e-6)
    assert len(np.unique(group[:10])) == len(np.unique(group[11:])) == 1
    assert group[9] != group[11]


def test_patches_that_do_not_touch_stay_apart():
    M, pairs = bands()
    np.testing.assert_array_equal(merged(M, pairs[:0], 1), np.arange(20))


def test_a_union_never_costs_less_than_its_pieces():
    M, pairs = bands()
    for a, b in pairs:
        assert costs(M[a : a + 1] + M[b : b + 1])[0] >= costs(M[[a, b]]).sum() - 1e-9
