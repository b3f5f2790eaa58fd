"""Laws of the camera ring and its silhouettes, on a ball whose image is known, and on a figure."""

import numpy as np
import pytest
import trimesh

from kinetree.errors import FigureError
from kinetree.tasks.numerics.input.cameras import camera_ring, silhouettes
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure

CENTRE = np.array([10.0, -4.0, 2.0])


def test_a_projection_matrix_splits_into_a_proper_rotation_and_an_upright_camera():
    for P in camera_ring(5, CENTRE, 3.0, (100, 140)).P:
        M = P[:, :3]
        forward = M[2]
        assert np.linalg.norm(forward) == pytest.approx(1.0)
        assert np.linalg.det(M) > 0.0
        place = -np.linalg.solve(M, P[:, 3])
        np.testing.assert_allclose(forward, (CENTRE - place) / np.linalg.norm(CENTRE - place), atol=1e-12)


def test_what_is_higher_stands_higher_in_every_image_and_the_centre_in_the_middle():
    uv = camera_ring(7, CENTRE, 3.0, (100, 140)).project(np.array([CENTRE, CENTRE + np.array([0, 0, 1.0])]))
    np.testing.assert_allclose(uv[:, 0], np.tile([69.5, 49.5], (7, 1)), atol=1e-9)
    assert (uv[:, 1, 1] < uv[:, 0, 1]).all()
    np.testing.assert_allclose(uv[:, 1, 0], 69.5, atol=1e-9)


def test_the_silhouette_of_a_ball_is_the_disc_that_fits_the_image():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=3.0)
    images = silhouettes(ball.vertices + CENTRE, ball.faces, camera_ring(4, CENTRE, 3.0, (100, 140)))
    rows, columns = np.mgrid[:100, :140]
    away = np.hypot(rows - 49.5, columns - 69.5)
    for image in images:
        assert image[away < 47.0].all()
        assert not image[away > 48.01].any()


def test_a_face_seen_from_behind_fills_the_same_pixels():
    V = CENTRE + np.array([[-1.0, 0.2, -1], [1, 0, -1], [0.3, 0, 1.3]])
    cameras = camera_ring(3, CENTRE, 3.0, (64, 64))
    front, back = (silhouettes(V, np.array([face]), cameras) for face in ([0, 1, 2], [2, 1, 0]))
    np.testing.assert_array_equal(front, back)
    assert front.any(axis=(1, 2)).all()


def test_silhouettes_of_a_moving_figure_contain_its_joints_and_stay_inside_the_image():
    arm = {
        "name": "arm",
        "joints": [
            {"name": "a", "position": [0, 0, 0], "radius": 1},
            {"name": "b", "parent": "a", "position": [0, 4, 0], "radius": 0.8},
            {"name": "c", "parent": "b", "position": [0, 4, 4], "radius": 0.6},
        ],
        "motions": {"turn": {"a": [{"axis": [0, 0, 1], "amplitude": 80}], "b": [{"axis": [1, 0, 0], "amplitude": 40}]}},
    }
    clip = Body.of(Figure.of(arm), frames=10, fps=10, vertices=800)
    cameras = clip.cameras(count=6, size=(120, 120))
    for t in (0, 3, 7):
        images = clip.silhouettes(t, cameras)
        uv = np.rint(cameras.project(clip.X[t])).astype(int)
        for image, places in zip(images, uv, strict=True):
            assert image[places[:, 1], places[:, 0]].all()
            assert not image[[0, -1]].any()
            assert not image[:, [0, -1]].any()


def test_a_ring_without_cameras_or_pixels_is_refused_in_words():
    with pytest.raises(FigureError, match="0 cameras of 100 × 100 pixels"):
        camera_ring(0, CENTRE, 1.0, (100, 100))
    with pytest.raises(FigureError, match="at least 8 × 8"):
        camera_ring(3, CENTRE, 1.0, (100, 2))
