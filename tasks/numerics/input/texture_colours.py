"""Colours of a texture at texture coordinates (glTF 2.0, Sec. 3.8.4: wrapped, bilinear)."""

from io import BytesIO

import numpy as np
from PIL import Image

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.input.pictures import Picture

_SIDE = 1024
"""Pixels to which a texture's longer side is reduced by averaging: vertices of captures lie farther apart than its own."""

_FARTHEST = 2.0**31
"""Textures' lengths from the origin beyond which a coordinate says nothing, as NaN does."""


def texture_colours(picture: Picture, uv: Floats) -> Floats:
    """Linear colours of a texture, between pixels bilinear, beyond its border repeated.

    uv      : (…, 2) from the picture's upper left
    returns : (…, rgb) linear, 0 to 1
    """
    with Image.open(BytesIO(picture.raw)) as image:
        reduced = image.convert("RGB").reduce(max(max(image.size) // _SIDE, 1))
    pixels = _decoded(np.asarray(reduced, dtype=np.float64) / 255.0)
    rows, columns = pixels.shape[:2]
    place = np.where(np.abs(uv) < _FARTHEST, uv, 0.0) * (columns, rows) - 0.5
    low = np.floor(place).astype(np.int64)
    part = (place - low)[..., None]
    c, r = low[..., 0], low[..., 1]
    corner = [pixels[(r + j) % rows, (c + i) % columns] for j in (0, 1) for i in (0, 1)]
    across = [a + (b - a) * part[..., 0, :] for a, b in (corner[:2], corner[2:])]
    return np.asarray(across[0] + (across[1] - across[0]) * part[..., 1, :])


def _decoded(srgb: Floats) -> Floats:
    """Linear light of sRGB (IEC 61966-2-1)."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
