"""Opened seams: every face of the cleaned mesh looks as the file's face at its place."""

import numpy as np
from shapes import sphere
from textured import MTL, corner_uv, obj, png

from kinetree.tasks.numerics.input.formats import mesh_of
from kinetree.tasks.numerics.input.mesh import clean
from kinetree.tasks.numerics.input.surface_appearance import surface_appearance
from kinetree.tasks.numerics.results.appearance import Seamed, seamed, vertex_colours


def read(V, F, uv):
    raw = obj(V, F, uv).encode()
    X, G = mesh_of(raw, "frame", ".obj")
    return clean(X, G), surface_appearance(raw, ".obj", G, {"skin.mtl": MTL.encode(), "skin.png": png()}.get)


def test_seams_are_welded_in_the_mesh_and_open_in_its_appearance():
    V, F = sphere(2)
    cleaned, surface = read(V, F, corner_uv(V, F))
    assert len(cleaned.V) == len(V)
    corners = seamed(surface, cleaned.vertex_map, cleaned.F)
    np.testing.assert_array_equal(corners.vertex[corners.faces], cleaned.F)
    np.testing.assert_allclose(corners.uv[corners.faces], corner_uv(cleaned.V, cleaned.F) * (1, -1) + (0, 1), atol=1e-12)
    assert len(V) < len(corners.vertex) < 3 * len(F)  # copies at seams alone
    assert len(np.unique(np.column_stack([corners.vertex, corners.uv]), axis=0)) == len(corners.vertex)


def test_faces_that_cleaning_turned_keep_the_look_of_their_corners():
    V, F = sphere(2)
    inside_out = F.copy()
    inside_out[::3] = inside_out[::3, [0, 2, 1]]
    cleaned, surface = read(V, inside_out, corner_uv(V, inside_out))
    assert cleaned.flipped > 0
    corners = seamed(surface, cleaned.vertex_map, cleaned.F)
    np.testing.assert_allclose(corners.uv[corners.faces], corner_uv(cleaned.V, cleaned.F) * (1, -1) + (0, 1), atol=1e-12)


def test_face_that_the_file_does_not_have_leaves_no_appearance():
    V, F = sphere(1)
    cleaned, surface = read(V, F, corner_uv(V, F))
    other = cleaned.F.copy()
    other[0] = (other[0, 0], other[0, 1], (other[0, 2] + 7) % len(cleaned.V))
    assert seamed(surface, cleaned.vertex_map, other) is None


def test_vertex_has_the_mean_of_what_its_faces_show_there():
    corners = Seamed(
        vertex=np.array([0, 0, 1, 2, 4]),
        faces=np.array([[0, 2, 3], [1, 3, 2], [1, 4, 3]]),
        uv=np.array([[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [1.1, -0.9], [0.1, 0.9]]),
        colour=np.array([[1, 1, 1], [1, 1, 1], [0.5, 1, 1], [1, 1, 1], [1, 1, 1]], float),
        material=np.array([0, 0, 1]),
    )
    picture = np.array([[[1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 1, 1]]], float)
    colours = vertex_colours(corners, np.array([[0.5, 0.5, 0.5], [0.2, 0.4, 0.8]]), [picture, None])
    upper_left, upper_right = np.array([0.5, 0, 0]), np.array([0, 0.5, 0])
    np.testing.assert_allclose(colours[0], (upper_left + upper_right + [0.2, 0.4, 0.8]) / 3)
    np.testing.assert_allclose(colours[1], [0.25, 0.5, 0.5])
    np.testing.assert_allclose(colours[2], (2 * upper_left + [0.2, 0.4, 0.8]) / 3)  # coordinates repeat
    assert np.isnan(colours[3]).all()
    np.testing.assert_allclose(colours[4], [0.2, 0.4, 0.8])
