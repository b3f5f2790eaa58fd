"""Where a texture begins and ends."""

from io import BytesIO

import numpy as np
from PIL import Image

from kinetree.tasks.numerics.input.pictures import Picture
from kinetree.tasks.numerics.input.texture_colours import texture_colours


def test_texture_begins_in_the_upper_left_and_repeats_beyond_its_border() -> None:
    stream = BytesIO()
    pixels = np.zeros((2, 2, 3), np.uint8)
    pixels[0, 1] = 255  # the upper right
    Image.fromarray(pixels).save(stream, "PNG")
    at = np.array([[0.75, 0.25], [0.25, 0.25], [1.75, -0.75], [0.75, 0.5]])
    colours = texture_colours(Picture(stream.getvalue(), "image/png"), at)[:, 0]
    np.testing.assert_allclose(colours, [1.0, 0.0, 1.0, 0.5], atol=1e-9)


def test_coordinates_that_say_nothing_are_those_of_the_corner() -> None:
    stream = BytesIO()
    Image.fromarray(np.arange(12, dtype=np.uint8).reshape(2, 2, 3)).save(stream, "PNG")
    at = np.array([[0.0, 0.0], [np.nan, np.nan], [np.inf, -np.inf], [1e300, -1e18]])
    colours = texture_colours(Picture(stream.getvalue(), "image/png"), at)
    np.testing.assert_array_equal(colours, colours[:1].repeat(4, axis=0))


def test_large_textures_are_averaged() -> None:
    stream = BytesIO()
    pixels = np.random.default_rng(0).integers(0, 2, (4096, 4, 1), dtype=np.uint8) * np.full(3, 255, np.uint8)
    Image.fromarray(pixels).save(stream, "PNG")
    at = np.stack([np.full(50, 0.5), np.linspace(0.1, 0.9, 50)], axis=1)
    assert texture_colours(Picture(stream.getvalue(), "image/png"), at).std() < 0.2
