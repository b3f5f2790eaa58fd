"""Colours at vertices, of materials, of vertices and of textures."""

import numpy as np
from textured import png

from kinetree.tasks.numerics.input.gltf_appearance import Material, SurfaceAppearance
from kinetree.tasks.numerics.input.pictures import Picture
from kinetree.tasks.numerics.registration.vertex_colour import vertex_colours

FACES = np.array([[0, 1, 2], [2, 1, 3]])
WHITE = Material("body", (1.0, 1.0, 1.0, 1.0), None)


def looks(uv=None, colour=None, material=(0, 0), materials=(WHITE,), pictures=()):
    return SurfaceAppearance(FACES, uv, colour, np.array(material), materials, pictures, ())


def test_colours_of_vertices_come_back_as_srgb() -> None:
    srgb = np.array([[0.0, 0.2, 1.0], [0.5, 0.5, 0.5], [0.1, 0.9, 0.3], [0.02, 0.04, 0.06]])
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    found = vertex_colours(looks(colour=linear[FACES]), np.arange(4), 4)
    np.testing.assert_allclose(found, srgb, atol=1e-9)


def test_welded_vertices_have_the_mean_and_dropped_ones_do_not_count() -> None:
    colour = np.zeros((2, 3, 3))
    colour[1] = 1.0
    found = vertex_colours(looks(colour=colour), np.array([0, 1, 1, -1]), 2)
    assert found is not None
    assert (found[0] == 0.0).all()
    np.testing.assert_allclose(found[1], 1.055 * 0.5 ** (1 / 2.4) - 0.055)


def test_texture_is_multiplied_by_its_material() -> None:
    shown = Picture(png((255, 0, 255)), "image/png")
    half = Material("skin", (0.5, 1.0, 0.0, 1.0), 0)
    seen = looks(uv=np.full((2, 3, 2), 0.3), material=(0, 1), materials=(half, WHITE), pictures=(shown,))
    found = vertex_colours(seen, np.arange(4), 4)
    assert found is not None
    np.testing.assert_allclose(found[0], [1.055 * 0.5 ** (1 / 2.4) - 0.055, 0.0, 0.0], atol=1e-9)


def test_one_colour_for_all_says_nothing() -> None:
    assert vertex_colours(looks(), np.arange(4), 4) is None
    assert vertex_colours(looks(uv=np.zeros((2, 3, 2))), np.arange(4), 4) is None
    shown = Picture(png((255, 0, 255)), "image/png")
    skin = Material("skin", (1.0, 1.0, 1.0, 1.0), 0)
    assert vertex_colours(looks(uv=np.full((2, 3, 2), 0.3), materials=(skin,), pictures=(shown,)), np.arange(4), 4) is None
