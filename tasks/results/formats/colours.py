"""The colours of files, pictures and pages, all defined here."""

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Floats, Ints
from kinetree.tasks.numerics.results.scene import part_colouring

BLUE, VERMILION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, YELLOW, BLACK, GREY = "#E69F00", "#56B4E9", "#F0E442", "#000000", "#7F7F7F"
"""Okabe and Ito's eight colours, which colour-blind people can tell apart, and a grey."""
PARTS = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILION, YELLOW, GREY)
"""Of rigid parts."""
LINES = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK, YELLOW)
"""Of curves, in the order in which they are used."""
KINDS = {"root": BLACK, "joint": VERMILION, "leaf": BLUE}
"""Of joints, by kind."""
SURFACE_LEAF = GREEN
"""Of leaves where they are seen on the surface."""
NOT_RIGID = "#FFFFFF"
"""Of surface that is not rigid."""
UNDER_BONES = 0.5
"""Share of white in the colours of parts that a skeleton is drawn over."""


def part_palette(label: Ints, faces: Ints) -> list[str]:
    """The colour of every part, for files, pictures and pages alike; parts that touch have different ones.

    label : (vertex,) part, −1 where the surface is not rigid
    faces : (face, corner)
    """
    return [PARTS[c] for c in part_colouring(np.asarray(label, np.int64), faces, len(PARTS))]


def part_colours(label: Ints, faces: Ints) -> NDArray[np.uint8]:
    """The same as numbers.

    returns : (part + 1, rgb) sRGB, 0 to 255; the last row is for label −1
    """
    return np.array([_rgb(c) for c in (*part_palette(label, faces), NOT_RIGID)], np.uint8)


def pale_part_colours(label: Ints, faces: Ints) -> Floats:
    """The same colours mixed with white, so that a skeleton is seen over them.

    returns : (part + 1, rgb) sRGB, 0 to 1; the last row is for label −1
    """
    own = part_colours(label, faces).astype(np.float64) / 255.0
    return (1.0 - UNDER_BONES) * own + UNDER_BONES


def linear(srgb: NDArray[np.uint8]) -> Floats:
    """Linear light of sRGB colours (IEC 61966-2-1).

    srgb    : (…,) 0 to 255
    returns : (…,) 0 to 1
    """
    c = srgb / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def srgb(light: Floats) -> NDArray[np.uint8]:
    """Colours (sRGB) of linear light, which `linear` undoes.

    light   : (…,) 0 to 1; what lies outside is clipped
    returns : (…,) 0 to 255
    """
    c = np.clip(light, 0.0, 1.0)
    return np.rint(255.0 * np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)).astype(np.uint8)


def _rgb(hexadecimal: str) -> tuple[int, ...]:
    """Three numbers from 0 to 255 of a colour such as #0072B2."""
    return tuple(bytes.fromhex(hexadecimal[1:]))
