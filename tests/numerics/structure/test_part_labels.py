"""Laws of labels over a surface."""

import numpy as np
from limbs import bent, rotation, tube

from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.structure.part_labels import border_edges, connected, relabelled

ANGLES = (0.5, 1.0, -0.5)


def hinge():
    V, F = tube()
    x = np.stack([bent(V, a, 0.01) for a in ANGLES])
    R = np.stack([np.stack([np.eye(3), rotation((1, 0, 0), a)]) for a in ANGLES])
    return V, x, R, np.zeros((3, 2, 3)), (V[:, 2] > 0).astype(np.int64), rings(F, len(V))


def test_a_border_moves_to_where_the_motion_changes():
    V, x, R, t, true, (start, ring) = hinge()
    found = relabelled(V, x, np.ones(x.shape[:2]), R, t, (V[:, 2] > 1.5).astype(np.int64), start, ring, 1)
    assert np.abs(V[found != true, 2]).max(initial=0) < 0.3


def test_what_is_not_believed_does_not_decide():
    V, x, R, t, true, (start, ring) = hinge()
    x[0] += 3.0
    weight = np.ones(x.shape[:2])
    weight[0] = 0.0
    assert np.abs(V[relabelled(V, x, weight, R, t, true, start, ring, 1) != true, 2]).max(initial=0) < 0.3


def test_islands_go_to_what_surrounds_them():
    V, _, _, _, true, (start, ring) = hinge()
    label = true.copy()
    label[(np.abs(V[:, 2] - 2.5) < 0.4) & (V[:, 0] > 0.2)] = 0
    assert (label != true).any()
    np.testing.assert_array_equal(connected(label, 2, start, ring), true)


def test_neighbours_are_counted_alike_from_both_sides():
    _, _, _, _, true, (start, ring) = hinge()
    near = border_edges(true, 3, start, ring)
    assert near[0, 1] == near[1, 0] > 0
    assert near[2].sum() == near[0, 0] == 0
