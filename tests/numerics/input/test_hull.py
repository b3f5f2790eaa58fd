"""Laws of the visual hull: it holds what is seen, no more than its views allow, and says which views do not fit."""

import numpy as np
import pytest
import trimesh
from ball_views import CENTRE, RING, ball_masks, long_ball

from kinetree.errors import HullError
from kinetree.tasks.numerics.input.cameras import camera_ring
from kinetree.tasks.numerics.input.hull import hull, view_box
from kinetree.tasks.numerics.input.isosurface import isosurface

NAMES = [f"cam_{c:02d}" for c in range(15)]
MASKS = list(ball_masks())
PIXEL = 10.0 / (0.96 * 160)
"""Width of a pixel at the ball's centre."""


def distances(field, points):
    """The field at points (point, xyz), between grid points."""
    from scipy.interpolate import RegularGridInterpolator

    axes = [field.origin[d] + field.spacing[d] * np.arange(field.values.shape[d]) for d in range(3)]
    return RegularGridInterpolator(axes, field.values)(points)


def test_hull_holds_the_body_within_half_a_pixel_and_is_little_larger():
    V, _ = long_ball()
    field = hull(MASKS, RING.P, 64)
    away = distances(field, V)
    assert away.min() > -0.5 * PIXEL
    assert np.median(away) < 0.2 * field.spacing[0]


def test_hull_surface_is_closed_and_holds_the_body_with_little_more():
    W, G = isosurface(hull(MASKS, RING.P, 64))
    surface = trimesh.Trimesh(W, G, process=False)
    body = trimesh.Trimesh(*long_ball(), process=False)
    assert surface.is_watertight
    assert surface.body_count == 1
    assert 0.99 * body.volume < surface.volume < 1.08 * body.volume


def test_surface_of_the_distance_is_several_times_closer_than_that_of_occupied_voxels():
    field = hull(MASKS, RING.P, 48)
    occupied = field.__class__(np.where(field.values > 0, 0.5, -0.5).astype(np.float32), field.origin, field.spacing)
    V, F = long_ball()
    normals = trimesh.Trimesh(V, F, process=False).vertex_normals
    errors = []
    for one in (field, occupied):
        W, _ = isosurface(one)
        nearest = np.linalg.norm(W[:, None, :] - V[None, ::4], axis=2).argmin(axis=1) * 4
        errors.append(np.std(np.einsum("vi,vi->v", W - V[nearest], normals[nearest])))
    assert errors[0] < 0.5 * errors[1]


def test_longest_side_of_the_body_has_as_many_voxels_as_asked_for_whatever_the_unit():
    for unit in (1.0, 1e-4, 1e5):
        P = RING.P.copy()
        P[:, :, 3] *= unit
        field = hull(MASKS, P, 80)
        inside = np.argwhere(field.values > 0)
        assert 76 <= (inside.max(axis=0) - inside.min(axis=0) + 1).max() <= 81
        np.testing.assert_allclose(field.origin / unit, hull(MASKS, RING.P, 80).origin, rtol=1e-5)


def test_hull_does_not_depend_on_the_scale_of_a_projection_matrix():
    scaled = RING.P * np.linspace(0.1, 7.0, 15)[:, None, None]
    np.testing.assert_allclose(hull(MASKS, scaled, 40).values, hull(MASKS, RING.P, 40).values, atol=1e-5)


def test_box_of_the_views_holds_the_body():
    V, _ = long_ball()
    low, high = view_box(MASKS, RING.P, NAMES)
    assert (low < V.min(axis=0)).all()
    assert (high > V.max(axis=0)).all()
    assert (high - low < 1.5 * np.ptp(V, axis=0)).all()


def test_a_view_that_cuts_the_body_does_not_cut_the_hull():
    cut = [mask.copy() for mask in MASKS]
    half = cut[0][:, 100:]
    assert half[:, 0].any()
    P = RING.P.copy()
    P[0, 0] -= 100 * P[0, 2]
    whole, part = hull(MASKS, RING.P, 48), hull([half, *cut[1:]], P, 48)
    V, _ = long_ball()
    assert distances(part, V).min() > -0.5 * PIXEL
    assert abs(part.values.size - whole.values.size) < 0.2 * whole.values.size


def test_views_that_bound_the_body_nowhere_are_refused():
    window = (slice(60, 100), slice(80, 120))
    P = RING.P.copy()
    P[:, 0] -= 80 * P[:, 2]
    P[:, 1] -= 60 * P[:, 2]
    with pytest.raises(HullError, match="leave the body open to one side: every silhouette that would bound it is cut"):
        hull([mask[window] for mask in MASKS], P, 32, names=NAMES)


def test_a_camera_that_looks_elsewhere_is_named():
    P = RING.P.copy()
    P[4] = camera_ring(15, CENTRE + np.array([0, 0, 30.0]), 5.0, (160, 200), elevation=30.0).P[4]
    with pytest.raises(HullError, match=r"no common point; .* without camera cam_04: check its calibration"):
        hull(MASKS, P, 32, names=NAMES)


def test_a_matrix_of_the_opposite_sign_is_named():
    P = RING.P.copy()
    P[7] *= -1.0
    with pytest.raises(HullError, match="the body is behind camera cam_07: the third row"):
        hull(MASKS, P, 32, names=NAMES)


def test_masks_whose_rectangles_meet_and_which_share_no_point_are_named():
    rows, columns = np.mgrid[:160, :200]
    frame = np.maximum(np.abs(rows - 79.5) / 70, np.abs(columns - 99.5) / 70)
    masks = [mask.copy() for mask in MASKS]
    masks[9] = (frame < 1) & (frame > 0.9)
    with pytest.raises(HullError, match="no point is inside all 15 silhouettes; at most 14 .* without camera cam_09"):
        hull(masks, RING.P, 32, names=NAMES)
