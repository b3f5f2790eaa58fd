"""The colours of parts, the same in every format."""

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Ints
from kinetree.tasks.numerics.results.scene import shades

PARTS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#7F7F7F")
"""Okabe and Ito's, grey for black."""
BLENDING = "#FFFFFF"
"""Surface that is not rigid."""


def part_colours(label: Ints, faces: Ints) -> NDArray[np.uint8]:
    """(part + 1, rgb) sRGB of every part, parts that touch in other colours; the last row is for label −1."""
    chosen = shades(np.asarray(label), faces, len(PARTS))
    return np.array([_rgb(PARTS[c]) for c in chosen] + [_rgb(BLENDING)], np.uint8)


def linear(srgb: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Bytes of sRGB as linear light, 0 to 1 (IEC 61966-2-1)."""
    c = srgb / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def _rgb(text: str) -> tuple[int, ...]:
    return tuple(bytes.fromhex(text[1:]))
