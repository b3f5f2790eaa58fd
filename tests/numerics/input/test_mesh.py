"""Laws of mesh cleaning, on spheres, boxes, tori and strips."""

from dataclasses import fields

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetree.errors import MeshError
from kinetree.tasks.numerics.geometry.orientation import oriented, winding
from kinetree.tasks.numerics.input.mesh import clean
from kinetree.tasks.numerics.input.welding import welded


def sphere(subdivisions=3, radius=1.0, centre=(0.0, 0.0, 0.0)):
    ball = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return np.array(ball.vertices) + centre, np.array(ball.faces, dtype=np.int32)


def box(extents=(1.0, 2.0, 3.0)):
    cuboid = trimesh.creation.box(extents=extents)
    return np.array(cuboid.vertices), np.array(cuboid.faces, dtype=np.int32)


def torus():
    ring = trimesh.creation.torus(major_radius=2.0, minor_radius=0.5)
    return np.array(ring.vertices), np.array(ring.faces, dtype=np.int32)


def strip(half_twists, n=24):
    """A closed band of n quads; an odd number of half twists makes it one-sided."""
    around = 2 * np.pi * np.arange(n) / n
    twist = half_twists * around / 2
    across = np.stack([np.cos(twist) * np.cos(around), np.cos(twist) * np.sin(around), np.sin(twist)], axis=1)
    middle = 3 * np.stack([np.cos(around), np.sin(around), 0 * around], axis=1)
    V = np.concatenate([middle - across, middle + across])
    low, high = np.arange(n), np.arange(n) + n
    next_low, next_high = np.roll(low, -1), np.roll(high, -1)
    if half_twists % 2:
        next_low[-1], next_high[-1] = next_high[-1], next_low[-1]
    F = np.concatenate([np.stack([low, next_low, high], axis=1), np.stack([next_low, next_high, high], axis=1)])
    return V, F.astype(np.int32)


def together(*meshes):
    begins = np.cumsum([0] + [len(V) for V, _ in meshes[:-1]])
    faces = [F + begin for (_, F), begin in zip(meshes, begins, strict=True)]
    return np.concatenate([V for V, _ in meshes]), np.concatenate(faces).astype(np.int32)


def soup(V, F):
    """Three vertices of its own for every face, as in an STL file."""
    return V[F].reshape(-1, 3), np.arange(3 * len(F), dtype=np.int32).reshape(-1, 3)


def as_sets(V, F):
    """Oriented triangles by coordinates: what a mesh is, however it is numbered."""
    corners = [tuple(map(tuple, triangle)) for triangle in np.round(V[F], 9).tolist()]
    return sorted(min((c, (c[1], c[2], c[0]), (c[2], c[0], c[1]))) for c in corners)


SHAPES = [sphere(), box(), torus(), strip(0), strip(1), together(sphere(), sphere(2, centre=(5, 0, 0)))]


def test_clean_closed_surface_is_returned_as_it_came():
    V, F = sphere()
    cleaned = clean(V, F)
    np.testing.assert_array_equal(cleaned.V, V)
    np.testing.assert_array_equal(cleaned.F, F)
    np.testing.assert_array_equal(cleaned.vertex_map, np.arange(len(V)))
    np.testing.assert_array_equal(cleaned.face_origin, np.arange(len(F)))
    assert cleaned.F.dtype == cleaned.vertex_map.dtype == np.int32
    assert (cleaned.merged, cleaned.unreferenced, cleaned.degenerate, cleaned.duplicate, cleaned.flipped) == (0,) * 5


@pytest.mark.parametrize(("shape", "euler"), [(sphere(), 2), (box(), 2), (torus(), 0), (strip(0), 0), (strip(1), 0)])
def test_euler_characteristic_is_that_of_the_shape(shape, euler):
    assert clean(*shape).euler == euler


def test_volume_and_area_of_a_box_are_exact():
    V, F = box((1.0, 2.0, 3.0))
    cleaned = clean(V + 100.0, F)
    assert cleaned.volume == pytest.approx(6.0, rel=1e-12)
    assert cleaned.area == pytest.approx(22.0, rel=1e-12)


def test_volume_of_a_fine_sphere_approaches_the_ball_and_is_never_above():
    volumes = [clean(*sphere(subdivisions)).volume for subdivisions in (2, 3, 4)]
    assert volumes == sorted(volumes)
    assert 0.995 < volumes[-1] / (4 / 3 * np.pi) < 1


def test_open_surface_has_boundary_edges_and_no_volume():
    V, F = box()
    cleaned = clean(V, F[2:])
    assert cleaned.boundary_edges == 4  # the first two faces share an edge
    assert np.isnan(cleaned.volume)
    hole = clean(sphere()[0], sphere()[1][1:])
    assert hole.boundary_edges == 3
    assert hole.euler == 1


def test_fin_on_a_box_makes_a_non_manifold_edge():
    V, F = box()
    fin = np.array([[F[0, 0], F[0, 1], len(V)]], dtype=np.int32)
    cleaned = clean(np.concatenate([V, [[9.0, 9.0, 9.0]]]), np.concatenate([F, fin]))
    assert cleaned.non_manifold_edges == 1
    assert cleaned.boundary_edges == 2
    assert np.isnan(cleaned.volume)


@pytest.mark.parametrize("shape", SHAPES)
def test_cleaning_twice_changes_nothing_more(shape):
    rng = np.random.default_rng(3)
    V, F = shape
    F = np.where(rng.random(len(F))[:, None] < 0.4, F[:, ::-1], F)
    V, F = together((V, F), sphere(1, radius=0.01, centre=(9, 9, 9)))
    once = clean(*soup(V, np.concatenate([F, F[:5], F[:3, [0, 0, 1]]])))
    twice = clean(once.V, once.F)
    np.testing.assert_array_equal(twice.V, once.V)
    np.testing.assert_array_equal(twice.F, once.F)
    assert (twice.merged, twice.flipped, twice.left_out_faces, twice.degenerate, twice.duplicate) == (0,) * 5


@pytest.mark.parametrize("shape", SHAPES)
def test_every_vertex_and_face_of_the_input_is_accounted_for(shape):
    V, F = together(shape, sphere(1, radius=0.01, centre=(9, 9, 9)))
    V = np.concatenate([V, V[:7], [[20.0, 20.0, 20.0]]])
    F = np.concatenate([F, F[:5], F[:3, [0, 0, 1]]])
    c = clean(V, F)
    assert (c.merged, c.unreferenced, c.degenerate, c.duplicate, c.left_out_faces) == (7, 1, 3, 5, 80)
    assert c.merged + c.unreferenced + c.left_out_vertices + len(c.V) == len(V)
    assert c.degenerate + c.duplicate + c.folded + c.left_out_faces + len(c.F) == len(F)


def test_fin_folded_flat_goes_and_leaves_the_surface_closed():
    V, F = sphere()
    a, b = F[0, :2]
    V = np.concatenate([V, [V[a] * 1.1]])
    tip = len(V) - 1
    cleaned = clean(V, np.concatenate([[[a, b, tip], [b, a, tip]], F]).astype(np.int32))
    assert (cleaned.folded, cleaned.duplicate, cleaned.unreferenced) == (2, 0, 1)
    np.testing.assert_array_equal(cleaned.F, F)
    assert cleaned.vertex_map[tip] == -1


def test_face_given_three_times_is_kept_once():
    V, F = sphere()
    cleaned = clean(V, np.concatenate([F, F[7:8], F[7:8, [0, 2, 1]]]))
    assert (cleaned.folded, cleaned.duplicate) == (0, 2)
    np.testing.assert_array_equal(cleaned.F, F)


def test_sheet_drawn_from_both_sides_becomes_one_sheet():
    V, F = sphere()
    cleaned = clean(V, np.concatenate([F, F[:, [0, 2, 1]]]))
    assert (cleaned.folded, cleaned.duplicate) == (0, len(F))
    np.testing.assert_array_equal(cleaned.F, F)


@pytest.mark.parametrize("shape", [sphere(), box(), torus()])
def test_surface_split_into_loose_faces_is_welded_again(shape):
    V, F = shape
    cleaned = clean(*soup(V, F))
    whole = clean(V, F)
    assert as_sets(cleaned.V, cleaned.F) == as_sets(whole.V, whole.F)
    assert cleaned.merged == 3 * len(F) - len(V)
    assert cleaned.boundary_edges == 0
    np.testing.assert_array_equal(cleaned.V[cleaned.vertex_map], V[F].reshape(-1, 3))


def test_seam_is_closed_within_the_tolerance_and_stays_open_beyond():
    V, F = soup(*sphere())
    V = V + np.random.default_rng(0).uniform(-1, 1, V.shape) * 1e-6
    assert clean(V, F, merge=1e-5).boundary_edges == 0
    assert clean(V, F, merge=1e-5).euler == 2
    assert clean(V, F, merge=0.0).merged == 0


def test_stray_vertex_far_away_does_not_widen_the_tolerance():
    V, F = sphere()
    cleaned = clean(np.concatenate([V, [[1e12, 0, 0], [1e300, 0, 0]]]), F)
    assert cleaned.merged == 0
    assert cleaned.euler == 2


def test_permuted_input_gives_the_permuted_result():
    rng = np.random.default_rng(1)
    V, F = together(torus(), sphere(1, radius=0.01, centre=(9, 9, 9)))
    F[::3] = F[::3, ::-1]
    where, rows = rng.permutation(len(V)), rng.permutation(len(F))
    permuted_V, permuted_F = np.empty_like(V), where[F][rows].astype(np.int32)
    permuted_V[where] = V
    a, b = clean(V, F), clean(permuted_V, permuted_F)
    assert as_sets(a.V, a.F) == as_sets(b.V, b.F)
    np.testing.assert_array_equal(a.vertex_map >= 0, b.vertex_map[where] >= 0)
    stays = a.vertex_map >= 0
    np.testing.assert_array_equal(a.V[a.vertex_map[stays]], b.V[b.vertex_map[where][stays]])


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_rigid_motion_and_scale_change_no_count(shape, scale):
    rng = np.random.default_rng(2)
    V, F = shape
    F = np.where(rng.random(len(F))[:, None] < 0.3, F[:, ::-1], F)
    R = trimesh.transformations.random_rotation_matrix(rng.random(3))[:3, :3]
    a, b = clean(V, F), clean(scale * (V @ R.T + [3.0, -2.0, 1.0]), F)
    np.testing.assert_array_equal(a.F, b.F)
    assert b.area == pytest.approx(scale**2 * a.area, rel=1e-6)
    assert b.volume == pytest.approx(scale**3 * a.volume, rel=1e-6, nan_ok=True)
    for field in fields(a):
        if field.type is int:
            assert getattr(a, field.name) == getattr(b, field.name), field.name


@pytest.mark.parametrize("shape", [sphere(), box(), torus()])
def test_flipped_patch_is_turned_back(shape):
    V, F = shape
    turned = F.copy()
    turned[: len(F) // 3] = turned[: len(F) // 3][:, [0, 2, 1]]
    cleaned = clean(V, turned)
    np.testing.assert_array_equal(cleaned.F, F)
    assert cleaned.flipped == len(F) // 3


def test_closed_components_face_outwards_each_by_itself():
    V, F = together(sphere(), sphere(centre=(5, 0, 0)))
    inverted = np.where(np.arange(len(F))[:, None] < len(F) // 2, F[:, [0, 2, 1]], F)
    np.testing.assert_array_equal(clean(V, inverted).F, F)


def test_open_body_faces_outwards_and_flat_sheet_keeps_its_side():
    V, F = sphere()
    holed = F[V[F].mean(axis=1)[:, 2] < 0.8]
    cleaned = clean(V, holed[:, [0, 2, 1]])
    np.testing.assert_array_equal(cleaned.F, cleaned.vertex_map[holed])
    sheet_V = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0.5, 0]], dtype=float)
    sheet_F = np.array([[0, 1, 2], [0, 2, 3], [1, 2, 4]], dtype=np.int32)  # the last one against the others
    np.testing.assert_array_equal(clean(sheet_V, sheet_F).F, [[0, 1, 2], [0, 2, 3], [1, 4, 2]])
    np.testing.assert_array_equal(clean(sheet_V, sheet_F[:, [0, 2, 1]]).F, [[0, 2, 1], [0, 3, 2], [1, 2, 4]])


def test_closed_surface_pressed_flat_keeps_its_side_because_its_volume_is_rounding_error():
    V, F = sphere()
    inverted = F[:, [0, 2, 1]]
    np.testing.assert_array_equal(clean(V * [1, 1, 1e-13], inverted, merge=0.0).F, inverted)
    np.testing.assert_array_equal(clean(V * [1, 1, 1e-3], inverted, merge=0.0).F, F)


def test_moebius_strip_is_told_from_a_band():
    assert clean(*strip(0)).disagreeing_edges == 0
    assert clean(*strip(1)).disagreeing_edges == 1
    assert clean(*strip(2)).disagreeing_edges == 0


def test_debris_is_dropped_and_a_second_body_kept():
    V, F = together(sphere(1, radius=0.1, centre=(3, 0, 0)), sphere(), sphere(radius=0.7, centre=(-3, 0, 0)))
    cleaned = clean(V, F)
    np.testing.assert_array_equal(cleaned.is_body, [False, True, True])
    assert cleaned.shares.sum() == pytest.approx(1)
    assert cleaned.shares[2] / cleaned.shares[1] == pytest.approx(0.49)
    assert (cleaned.vertex_map[:42] == -1).all()
    np.testing.assert_array_equal(cleaned.V, V[42:])


def test_largest_component_is_kept_whatever_its_share():
    many = [sphere(1, radius=1 + 0.01 * i, centre=(4 * i, 0, 0)) for i in range(30)]
    cleaned = clean(*together(*many))
    np.testing.assert_array_equal(np.flatnonzero(cleaned.is_body), [29])


def test_pieces_that_touch_in_one_vertex_are_two_components():
    V, F = sphere(1)
    other_V, other_F = sphere(1, radius=0.1)
    cleaned = clean(*together((V, F), (other_V - other_V[0] + V[0] * 1.0, other_F)))
    assert cleaned.merged == 1
    np.testing.assert_array_equal(cleaned.is_body, [True, False])


def test_shell_inside_a_body_is_recognised_and_dropped_and_one_beside_it_is_not():
    inner, outer = sphere(radius=0.6), sphere()
    inside_out = inner[0], inner[1][:, [0, 2, 1]]
    for cavity in (inner, inside_out):
        cleaned = clean(*together(cavity, outer))
        assert cleaned.nested == 1
        np.testing.assert_array_equal(cleaned.is_body, [False, True])
        assert cleaned.volume == pytest.approx(clean(*outer).volume)
    assert clean(*together(sphere(radius=0.6, centre=(0.7, 0, 0)), outer)).nested == 0
    assert clean(*together(sphere(radius=0.3), torus())).nested == 0  # in the hole, not in the ring


def test_winding_number_is_one_inside_and_nought_outside():
    V, F = sphere()
    P = np.array([[0, 0, 0], [0.3, 0.2, -0.5], [0, 0, 0.97], [0, 0, 1.01], [5, 5, 5.0]])
    np.testing.assert_allclose(winding(P, V, F), [1, 1, 1, 0, 0], atol=1e-12)


def test_needle_is_kept_because_without_it_the_surface_would_open():
    V, F = box()
    a, b, c = F[0]
    middle = len(V)  # a vertex on edge ab that only the face on this side knows: ab itself stays as a needle
    V = np.concatenate([V, [(V[a] + V[b]) / 2]])
    F = np.concatenate([[[a, middle, c], [middle, b, c], [a, b, middle]], F[1:]]).astype(np.int32)
    cleaned = clean(V, F)
    assert cleaned.needles == 1
    assert cleaned.boundary_edges == 0
    assert cleaned.volume == pytest.approx(6)


def test_labels_come_back_to_the_vertices_they_were_made_of():
    V, F = together(soup(*sphere()), sphere(1, radius=0.05, centre=(3, 0, 0)))
    cleaned = clean(V, F)
    height = cleaned.V[:, 2]
    back = np.where(cleaned.vertex_map >= 0, height[cleaned.vertex_map], np.nan)
    np.testing.assert_array_equal(back[:-42], V[:-42, 2])
    assert np.isnan(back[-42:]).all()


@given(st.lists(st.tuples(*[st.integers(0, 2)] * 3), min_size=1, max_size=40))
def test_welding_maps_every_vertex_to_the_first_equal_one(points):
    first = welded(np.array(points, dtype=float), 1e-7)
    np.testing.assert_array_equal(first, [points.index(p) for p in points])


@given(st.lists(st.floats(0, 1), min_size=1, max_size=30), st.floats(1e-3, 0.2))
def test_welded_vertices_that_stay_are_further_apart_than_the_tolerance(places, tolerance):
    X = np.stack([places, np.zeros(len(places)), np.zeros(len(places))], axis=1)
    first = welded(X, tolerance)
    assert (first <= np.arange(len(X))).all()
    np.testing.assert_array_equal(first[first], first)
    stay = np.sort(X[np.unique(first), 0])
    assert (np.diff(stay) > tolerance * (1 - 1e-12)).all()


@settings(max_examples=50)
@given(st.data())
def test_any_faces_turned_any_way_end_up_agreeing(data):
    V, F = sphere(1)
    turn = np.array(data.draw(st.lists(st.booleans(), min_size=len(F), max_size=len(F))))
    turned, component = oriented(V, np.where(turn[:, None], F[:, [0, 2, 1]], F))
    np.testing.assert_array_equal(turned, turn)
    assert not component.any()


@pytest.mark.parametrize(
    ("V", "F", "words"),
    [
        (sphere()[0], np.empty((0, 3), np.int32), "no faces, only 642 vertices"),
        (np.eye(3), np.array([[0, 0, 1], [1, 2, 2]], np.int32), "its 2 faces have no area"),
        (np.outer(np.arange(3.0), [1, 2, 3]), np.array([[0, 1, 2]], np.int32), "its 1 faces have no area"),
        (np.ones((3, 3)), np.array([[0, 1, 2]], np.int32), "its bounding box has a diagonal of 0;"),
        (np.eye(3) * 1e300, np.array([[0, 1, 2]], np.int32), r"a diagonal of 1.73e\+300; the coordinates are damaged"),
    ],
)
def test_what_has_no_surface_is_refused_by_name(V, F, words):
    with pytest.raises(MeshError, match=words) as refused:
        clean(V, F, name="frame_7.ply")
    assert str(refused.value).startswith("frame_7.ply: ")
