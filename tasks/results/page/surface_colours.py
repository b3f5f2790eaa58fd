"""The colours of the input at the vertices of the reference mesh, for the player (ours)."""

from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinetree.schemas.array import Floats
from kinetree.schemas.results.appearance import Appearance
from kinetree.tasks.numerics.results.appearance import Seamed, vertex_colours
from kinetree.tasks.results.formats.colours import linear, srgb

SIDE = 512
"""Pixels along a side to which a picture is reduced, which averages it: vertices are far apart."""
MOST_PIXELS = 10**8
"""Of a picture that is unpacked."""


def surface_colours(appearance: Appearance, vertices: int) -> NDArray[np.uint8] | None:
    """(vertex, rgb) sRGB of every vertex of the reference mesh, grey where none is known; None without any.

    vertices : of the reference mesh
    """
    if appearance.frame is None or not (appearance.has_uv or appearance.has_colour or _several(appearance)):
        return None
    ends = np.cumsum(appearance.sizes)
    content = appearance.content.tobytes()
    pictures = [_pixels(content[end - size : end]) for size, end in zip(appearance.sizes, ends, strict=True)]
    corners = Seamed(
        vertex=np.array(appearance.vertex),
        faces=np.array(appearance.faces),
        uv=np.array(appearance.uv)[:, : 2 * appearance.has_uv],
        colour=np.array(appearance.colour)[:, : 3 * appearance.has_colour],
        material=np.array(appearance.material),
    )
    base = np.array([material.colour[:3] for material in appearance.materials])
    textures = [None if material.picture is None else pictures[material.picture] for material in appearance.materials]
    known = vertex_colours(corners, base, textures)
    colours = np.full((vertices, 3), np.nan)
    colours[: len(known)] = known[:vertices]
    return srgb(np.where(np.isnan(colours), 0.5, colours))


def _several(appearance: Appearance) -> bool:
    """Whether materials differ in colour."""
    return len({material.colour for material in appearance.materials}) > 1


def _pixels(raw: bytes) -> Floats | None:
    """(row, column, rgb) linear; None where the picture cannot be unpacked, or is too large for that."""
    try:
        with Image.open(BytesIO(raw), formats=["PNG", "JPEG"]) as image:
            if image.width * image.height > MOST_PIXELS:
                return None
            image.draft("RGB", (SIDE, SIDE))
            small = image.convert("RGB")
            small.thumbnail((SIDE, SIDE))
            return linear(np.asarray(small))
    except Exception:  # of many kinds; a damaged picture leaves the colour of its material
        return None
