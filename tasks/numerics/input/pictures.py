"""Pictures that textures are made of, held against bounds before they are unpacked."""

from io import BytesIO
from typing import NamedTuple

from PIL import Image

MOST_BYTES = 64 * 2**20
"""Of one file."""
_MOST_SIDE = 16384
"""Pixels; graphics cards show no larger textures."""
_KEPT = {"PNG": "image/png", "JPEG": "image/jpeg"}
"""Formats that glTF holds as they are."""
_CONVERTED = ("BMP", "TGA", "TIFF", "WEBP")


class Picture(NamedTuple):
    """The bytes of a picture and their media type, image/png or image/jpeg."""

    raw: bytes
    media: str


def picture(raw: bytes) -> Picture | str:
    """A picture from the bytes of a file, as PNG or JPEG; a sentence that says why it is none."""
    if len(raw) > MOST_BYTES:
        return f"{len(raw)} bytes, more than {MOST_BYTES}"
    try:
        with Image.open(BytesIO(raw), formats=[*_KEPT, *_CONVERTED]) as image:
            if max(image.size) > _MOST_SIDE:
                return f"{image.size[0]} × {image.size[1]} pixels, more than {_MOST_SIDE} along a side"
            if image.format in _KEPT:
                image.verify()
                return Picture(raw, _KEPT[image.format])
            png = BytesIO()
            image.convert("RGBA" if "A" in image.getbands() else "RGB").save(png, "PNG")
            return Picture(png.getvalue(), "image/png")
    except Exception as error:  # of many kinds, some of them undocumented
        return f"cannot be read as a picture ({type(error).__name__})"
