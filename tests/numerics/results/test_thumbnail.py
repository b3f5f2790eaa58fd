"""Laws of the small picture of a body."""

import numpy as np
from shapes import sphere

from kinetree.tasks.numerics.results.thumbnail import BONE, MARGIN, SIDE, thumbnail

NONE = np.zeros((0, 3)), np.zeros(0, np.int64)
RED = np.array([255, 0, 0], np.uint8)


def drawn(V, F, up=2, colour=None):
    return thumbnail(V, F, np.tile(RED, (len(V), 1)) if colour is None else colour, *NONE, up)


def covered(image):
    return (image != 255).any(axis=2)


def test_a_sphere_is_a_full_disc():
    V, F = sphere(3)
    disc = covered(drawn(V, F))
    radius = (SIDE - 2 * MARGIN - 1) / 2
    rows, columns = np.mgrid[:SIDE, :SIDE] - (SIDE - 1) / 2
    inside = np.hypot(rows, columns) < radius - 2
    assert disc[inside].all()
    assert not disc[np.hypot(rows, columns) > radius + 2].any()


def test_the_picture_does_not_depend_on_place_and_unit():
    V, F = sphere(2)
    V = V * [3.0, 1.0, 2.0]
    image = drawn(V, F)
    assert np.mean(image != drawn(1000.0 * V + [5.0, -7.0, 9.0], F)) < 0.01


def test_up_points_up():
    V, F = sphere(3)
    V = V * [1.0, 1.0, 3.0]
    colour = np.where(V[:, 2:] > 0, RED, np.array([0, 0, 255], np.uint8)).astype(np.uint8)
    for up, top in ((2, 0), (~2, 2)):
        image = drawn(V, F, up, colour)
        upper = image[: SIDE // 3][covered(image)[: SIDE // 3]]
        assert (upper[:, top] > upper[:, 2 - top]).all()


def test_what_is_nearer_hides_what_is_behind():
    square, F = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float), np.array([[0, 1, 2], [0, 2, 3]])
    sheets = [np.insert(square, 1, depth, axis=1) for depth in (0.0, 0.1)]  # upright, facing along y
    V, both = np.concatenate(sheets), np.concatenate([F, F + 4])
    blue = np.array([0, 0, 255], np.uint8)
    image = thumbnail(V, both, np.concatenate([np.tile(RED, (4, 1)), np.tile(blue, (4, 1))]), *NONE, 2)
    middle = image[SIDE // 3 : -SIDE // 3, SIDE // 3 : -SIDE // 3].reshape(-1, 3).astype(int)
    assert (middle[:, 0] > middle[:, 2]).all()  # rightward is x, upward z, so that the viewer looks along +y


def test_bones_are_drawn_in_front():
    V, F = sphere(3)
    joints = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    image = thumbnail(V, F, np.tile(RED, (len(V), 1)), joints, np.array([-1, 0]), 2)
    assert (image[SIDE // 2, SIDE // 2] == BONE).all()


def test_a_body_without_surface_is_points():
    assert covered(drawn(np.eye(3), np.zeros((0, 3), int))).any()
