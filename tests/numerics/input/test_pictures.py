"""Pictures are kept as they are, made PNG, or refused in words."""

import pytest
from PIL import Image
from textured import png

from kinetree.tasks.numerics.input import pictures
from kinetree.tasks.numerics.input.pictures import Picture, picture


@pytest.mark.parametrize(("form", "media"), [("PNG", "image/png"), ("JPEG", "image/jpeg")])
def test_what_gltf_holds_is_kept_to_the_byte(form, media):
    assert picture(png(form=form)) == Picture(png(form=form), media)


@pytest.mark.parametrize("form", ["BMP", "TIFF", "TGA"])
def test_other_pictures_become_png_with_the_same_pixels(form):
    from io import BytesIO

    converted = picture(png(form=form))
    assert converted.media == "image/png"
    with Image.open(BytesIO(converted.raw)) as image:
        assert image.getpixel((0, 0)) == (200, 30, 30)


def test_what_is_no_picture_or_too_large_is_said(monkeypatch):
    assert picture(b"not a picture") == "cannot be read as a picture (UnidentifiedImageError)"
    monkeypatch.setattr(pictures, "_MOST_SIDE", 8)
    assert picture(png(size=(9, 2))) == "9 × 2 pixels, more than 8 along a side"
    monkeypatch.setattr(pictures, "MOST_BYTES", 10)
    assert "more than 10" in picture(png())
