"""Colours at the vertices of a mesh, from the colours and textures at the corners of its file's faces (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.input.gltf_appearance import SurfaceAppearance
from kinetree.tasks.numerics.input.texture_colours import texture_colours


def vertex_colours(found: SurfaceAppearance, vertex_map: Ints, vertices: int) -> Floats | None:
    """The mean of the colours that each vertex has at the corners of its faces; None where all have one colour.

    found      : of the file
    vertex_map : (input_vertex,) vertex of the cleaned mesh, −1 where it was dropped
    vertices   : of the cleaned mesh
    returns    : (vertex, rgb) sRGB from 0 to 1; the mean of all where no face of the file is left
    """
    colour = np.array([m.colour[:3] for m in found.materials])[found.material][:, None, :] * np.ones((1, 3, 1))
    if found.colour is not None:
        colour = colour * found.colour
    if found.uv is not None:
        for number, material in enumerate(found.materials):
            faces = found.material == number
            if material.picture is not None and faces.any():
                colour[faces] *= texture_colours(found.pictures[material.picture], found.uv[faces])
    if not len(colour) or not np.ptp(colour.reshape(-1, 3), axis=0).any():
        return None
    at = vertex_map[found.faces].ravel()
    kept = at >= 0
    rows = colour.reshape(-1, 3)[kept]
    count = np.bincount(at[kept], minlength=vertices).astype(np.float64)
    total = np.stack([np.bincount(at[kept], rows[:, k], minlength=vertices) for k in range(3)], axis=1)
    other = rows.mean(axis=0) if len(rows) else np.zeros(3)
    mean = np.where(count[:, None] > 0, total / np.maximum(count, 1.0)[:, None], other)
    return _encoded(mean)


def _encoded(linear: Floats) -> Floats:
    """Colours of linear light as sRGB (IEC 61966-2-1)."""
    c = np.clip(linear, 0.0, 1.0)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1.0 / 2.4) - 0.055)
