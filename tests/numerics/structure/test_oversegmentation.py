"""Laws of the deliberately many parts to begin with."""

import numpy as np
from limbs import bent, tube
from shipped import FIRST_CUT

from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.oversegmentation import (
    NO_CONE,
    SHARED,
    cone_runs,
    grouped,
    patches,
)

COARSE = FIRST_CUT._replace(rings=40, cut=0.05)


def hinge():
    V, F = tube()
    x = np.stack([bent(V, a, 0.01) for a in (0.3, 0.8, -0.4)])
    return Surface.of(V, F), V, x, np.ones(x.shape[:2]), rings(F, len(V))


def test_patches_cover_the_surface_evenly():
    surface, V, _, _, (start, ring) = hinge()
    patch = patches(surface, V, start, ring, 30)
    np.testing.assert_array_equal(np.unique(patch), np.arange(30))
    assert np.bincount(patch, surface.area).max() < 4 * surface.area.sum() / 30


def test_runs_of_one_leaf_end_at_the_hinge():
    surface, V, x, weight, (start, ring) = hinge()
    run = cone_runs(surface, V, x, weight * surface.area, np.array([len(V) - 1]), start, ring, COARSE).label
    for k in np.unique(run):
        z = V[run == k, 2]
        assert z.min() > -0.4 or z.max() < 0.4


def test_both_limbs_are_cut_where_each_one_s_cone_holds_the_whole_body():
    surface, V, x, weight, (start, ring) = hinge()
    leaves = np.array([V[:, 2].argmin(), V[:, 2].argmax()])
    found = cone_runs(surface, V, x, weight * surface.area, leaves, start, ring, COARSE)
    run, end = found.label, 0.6 * V[:, 2].max()
    assert (run[np.abs(V[:, 2]) > end] >= 0).all()
    assert (run[np.abs(V[:, 2]) < 0.05 * end] == -1).all()
    assert (found.cone[np.abs(V[:, 2]) < 0.05 * end] == SHARED).all()
    for k in np.unique(run[run >= 0]):
        z = V[run == k, 2]
        assert z.min() > 0 or z.max() < 0


def test_rings_runs_and_merge_errors_are_those_of_the_cut():
    surface, V, x, weight, (start, ring) = hinge()
    leaf = int(V[:, 2].argmax())
    found = cone_runs(surface, V, x, weight * surface.area, np.array([leaf]), start, ring, COARSE)
    inside = found.cone == 0
    assert found.ring[leaf] == 0
    assert ((found.ring >= 0) == inside).all()
    assert (found.label >= 0).tolist() == inside.tolist()
    np.testing.assert_array_equal(found.run[0, found.ring[inside]], found.label[inside])
    rings = int((found.run[0] >= 0).sum())
    assert np.isnan(found.merge[0, rings - 1 :]).all()
    worst = int(np.nanargmax(found.merge[0]))
    assert abs(V[found.ring == worst, 2].min()) < 0.4
    assert found.merge[0, worst] > COARSE.cut


def test_without_leaves_there_is_no_run():
    surface, V, x, weight, (start, ring) = hinge()
    found = cone_runs(surface, V, x, weight, np.zeros(0, np.int64), start, ring, COARSE)
    assert (found.label == -1).all()
    assert (found.cone == NO_CONE).all()
    assert found.run.shape == found.merge.shape == (0, 40)


def test_groups_stay_within_their_label_and_apart_where_the_motion_differs():
    surface, V, x, weight, (start, ring) = hinge()
    patch = patches(surface, V, start, ring, 60)
    label = np.where(V[:, 0] > 0, 0, -1)
    group = grouped(V, x, weight, patch, label, start, ring, 2, np.inf)
    assert ((group >= 0) == (label >= 0)).all()
    sides = [V[group == k, 2] for k in (0, 1)]
    assert min(abs(sides[0].mean() - sides[1].mean()), 9) > 3
    assert (grouped(V, x, weight, patch, np.full(len(V), -1), start, ring, 2, np.inf) == -1).all()
