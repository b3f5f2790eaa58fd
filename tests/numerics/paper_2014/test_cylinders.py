"""Laws of the undefined area: a pipe of three arms, each with a cone that reaches past the middle of the body."""

import numpy as np
from articulated import chain, swings
from shapes import open_cylinder, y_pipe

from kinetree.tasks.numerics.paper_2014.cones import bands, components, edges, grown
from kinetree.tasks.numerics.paper_2014.cylinders import (
    Cylinder,
    CylindersSettings,
    IntervalMotion,
    cylinders,
    kinematic_cones,
    rigid_annuli,
)

V, F, _ = y_pipe()
DIRECTION = np.stack([[np.cos(a), np.sin(a), 0.0] for a in (0.0, 2 * np.pi / 3, 4 * np.pi / 3)])
DISTANCE = np.linalg.norm(V[None] - 28.0 * DIRECTION[:, None], axis=2)
AREA = np.ones(len(V))
ANNULUS = np.stack([grown(bands(d, 25), np.arange(len(V)) == np.argmin(d), AREA, edges(F)) for d in DISTANCE])


def all_rigid(annuli):
    return np.ones(len(annuli), bool)


def test_cones_overlap_at_the_branch_and_what_they_share_is_cut_off():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    assert ((ANNULUS >= 0).sum(axis=0) > 1).any()
    cut = kinematic_cones(ANNULUS, rigid, AREA)
    assert [p.annulus.max() for p in cut] == [4, 4, 4], "the rigid area beyond the joint is cut off, the joint is not"
    assert (sum((p.annulus >= 0).astype(int) for p in cut) <= 1).all()


def test_cone_whose_last_annulus_is_not_rigid_is_cut_before_the_rigid_area_that_is_shared():
    shared = ((ANNULUS >= 0).sum(axis=0) > 1) & (ANNULUS[0] >= 0)
    first, last = ANNULUS[0][shared].min(), ANNULUS[0].max()
    assert last >= first + 2, "the shared end is long enough for a rigid area and a joint"
    rigid = np.ones((3, 25), bool)
    rigid[:, [first - 1, last]] = False
    for cylinder in kinematic_cones(ANNULUS, rigid, AREA):
        assert cylinder.annulus.max() == first - 1
        assert not cylinder.rigid[-1], "it ends in the joint before the area that is cut off"


def test_ring_that_is_mostly_shared_is_cut_off_with_all_beyond_and_one_that_is_mostly_its_own_stays():
    band = np.arange(40) // 4  # ten rings of four vertices; another cone shares two of each from ring 6 on
    other = np.where((band >= 6) & (np.arange(40) % 4 < 2), band, -1)
    joints = np.zeros((2, 10), bool)
    for own_area, last in ((1.1, 9), (0.9, 5)):
        area = np.where(np.arange(40) % 4 < 2, 1.0, own_area)
        cone, _ = kinematic_cones(np.stack([band, other]), joints, area)
        assert cone.annulus.max() == last


def test_cone_without_a_joint_keeps_what_is_its_own():
    cut = kinematic_cones(ANNULUS, np.ones((3, 25), bool), AREA)
    for n, cylinder in enumerate(cut):
        alone = ((ANNULUS >= 0).sum(axis=0) == 1) & (ANNULUS[n] >= 0)
        whole = [k for k in range(ANNULUS[n].max() + 1) if alone[ANNULUS[n] == k].all()]
        assert alone[cylinder.annulus >= 0].all()
        assert np.isin(whole, cylinder.annulus).all()


def test_cone_that_overlaps_with_nothing_is_left_whole():
    (cylinder,) = kinematic_cones(ANNULUS[:1], np.ones((1, 25), bool), AREA)
    assert (cylinder.annulus == ANNULUS[0]).all()


def test_cylinders_define_all_of_the_surface_and_nothing_twice():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    cones = kinematic_cones(ANNULUS, rigid, AREA)
    extensions = cylinders(cones, DISTANCE, AREA, F, all_rigid, 25)
    claimed = sum((p.annulus >= 0).astype(int) for p in (*cones, *extensions))
    assert claimed.max() == 1
    component = components(claimed == 0, edges(F))
    assert np.bincount(component[component >= 0]).max(initial=0) < CylindersSettings().least_area * len(V)


def test_first_cylinder_is_the_extension_with_the_widest_range():
    rigid = np.ones((3, 25), bool)
    for cone, joint in enumerate((2, 5, 5)):
        rigid[cone, joint] = False
    extensions = cylinders(kinematic_cones(ANNULUS, rigid, AREA), DISTANCE, AREA, F, all_rigid, 25)
    assert extensions[0].cone == 0


def test_annuli_of_a_cylinder_are_numbered_from_its_near_end():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    clustered = []
    extensions = cylinders(
        kinematic_cones(ANNULUS, rigid, AREA), DISTANCE, AREA, F, lambda a: clustered.append(a) or all_rigid(a), 25
    )
    for cylinder, annuli in zip(extensions, clustered, strict=True):
        reach = [DISTANCE[cylinder.cone][inside].mean() for inside in annuli]
        assert reach == sorted(reach)


def test_extension_begins_behind_the_last_annulus_of_its_cone_and_not_beside_it():
    X, faces = open_cylinder(24, 51, height=10.0)
    distance = X[None, :, 2] + 1e-9
    band = bands(distance[0], 10)
    lost = (band == 4) & (X[:, 0] > 0.5)
    cone = Cylinder(0, np.where((band <= 4) & ~lost, band, -1), np.ones(5, bool))
    (extension,) = cylinders([cone], distance, np.ones(len(X)), faces, all_rigid, 10)
    assert (extension.annulus == np.where(band > 4, band - 5, -1)).all()


def test_cone_whose_leaf_is_not_seen_is_not_extended():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    unseen = DISTANCE.copy()
    unseen[0] = np.nan
    extensions = cylinders(kinematic_cones(ANNULUS, rigid, AREA), unseen, AREA, F, all_rigid, 25)
    assert 0 not in {p.cone for p in extensions}


def test_body_without_cones_has_no_cylinders():
    assert cylinders([], np.zeros((0, len(V))), AREA, F, all_rigid, 25) == []


def test_undefined_components_that_are_small_are_not_extended_into():
    cones = kinematic_cones(ANNULUS, np.ones((3, 25), bool), AREA)
    assert cylinders(cones, DISTANCE, AREA, F, all_rigid, 25)
    assert cylinders(cones, DISTANCE, AREA, F, all_rigid, 25, CylindersSettings(least_area=1.1)) == []


def test_annulus_is_rigid_only_if_it_is_so_in_all_intervals_that_have_it():
    body = chain((0.0,), swings(12, 2, degrees=60.0, axes=1))
    of_vertex = np.minimum(((body.V[:, 2] + 5.0) / 0.8).astype(int), 11)
    annuli, every = [np.flatnonzero(of_vertex == k) for k in range(12)], np.arange(len(body.V))
    bending = IntervalMotion(body.x, every, 1e-4, False)
    at_rest = bending._replace(at_rest=True)
    elsewhere = bending._replace(model_vertex=np.full(len(every), -1))
    (joint,) = np.flatnonzero(~rigid_annuli(annuli, [at_rest, bending, elsewhere], 1.5, len(every)))
    assert abs(body.V[annuli[joint], 2].mean()) < 0.9
    assert rigid_annuli(annuli, [at_rest, elsewhere], 1.5, len(every)).all()
