"""Laws of elimination: what neighbours explain goes, what they do not stays."""

import numpy as np
from limbs import bent, tube
from shipped import ELIMINATION

from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.structure.elimination import NormalisedBody, eliminated, rims
from kinetree.tasks.numerics.structure.part_motion import fit
from kinetree.tasks.numerics.structure.score_spans import score_spans


def hinge(angles, bands=10):
    """A tube with a hinge in too many parts: bands along it."""
    V, F = tube()
    V = V / 12
    x = np.stack([bent(V, a, 0.001) for a in angles])
    area = np.full(len(V), 1 / len(V))
    N = V * [1, 1, 0] / np.linalg.norm(V[:, :2] + 1e-9, axis=1)[:, None]
    body = NormalisedBody(V, N, F, x, np.ones(x.shape[:2]), area, *rings(F, len(V)), score_spans(len(x), None))
    label = np.minimum(((V[:, 2] * 12 + 5) / 10 * bands).astype(np.int64), bands - 1)
    R, t = np.empty((len(x), bands, 3, 3)), np.empty((len(x), bands, 3))
    fit(V, x, body.weight, area, label, np.ones(bands, bool), False, 10_000, 1e-10, R, t)
    return body, label, R, t


def test_of_many_bands_of_a_hinge_its_two_sides_are_left():
    body, label, R, t = hinge((0.3, 0.8, -0.4))
    found = eliminated(body, label, R, t, ELIMINATION).label
    kept = np.unique(found)
    assert len(kept) == 2
    low, high = (body.V[found == k, 2] for k in kept)
    assert max(low.min(), high.min()) > -0.05
    assert min(low.max(), high.max()) < 0.05


def test_what_does_not_move_is_one_part():
    body, label, R, t = hinge((0.0, 0.0))
    assert len(np.unique(eliminated(body, label, R, t, ELIMINATION).label)) == 1


def test_parts_that_are_removed_and_what_each_cost_are_told_in_order():
    body, label, R, t = hinge((0.3, 0.8, -0.4))
    settings = ELIMINATION._replace(removal_cost=0.02)
    found = eliminated(body, label, R, t, settings)
    np.testing.assert_array_equal(np.sort([*found.removed, *np.unique(found.label)]), np.arange(10))
    assert 0.0 <= found.cost.min() <= found.cost.max() < 0.02
    first = eliminated(body, label, R, t, settings._replace(removal_cost=np.nextafter(found.cost[0], 1.0)))
    assert first.removed[0] == found.removed[0]


def test_asked_again_nothing_goes():
    body, label, R, t = hinge((0.3, 0.8, -0.4))
    for missed in (1e-6, 1e-4, 0.0025):
        settings = ELIMINATION._replace(removal_cost=missed)
        first = eliminated(body, label, R, t, settings)
        again = eliminated(body, first.label, first.R, first.t, settings)
        np.testing.assert_array_equal(again.label, first.label)
        assert len(again.removed) == len(again.cost) == 0


def test_a_lower_bar_never_leaves_fewer_parts():
    body, label, R, t = hinge((0.3, 0.8, -0.4))
    settings = [ELIMINATION._replace(removal_cost=cost) for cost in (1e-9, 0.0025, 0.02, 1.0)]
    counts = [len(np.unique(eliminated(body, label, R, t, one).label)) for one in settings]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] == 1


def test_the_rim_of_a_band_is_its_two_girths():
    body, label, _, _ = hinge((0.0,))
    sections = 2 * np.pi * np.sqrt((1 + 0.7**2) / 2) / 12
    np.testing.assert_allclose(rims(body.V, body.F, label, 10)[5], 2 * sections, rtol=0.02)
