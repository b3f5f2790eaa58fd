"""The appearance of one frame's file on the cleaned mesh, whose seams are welded (ours)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Faces, Floats, Ints, Labels
from kinetree.tasks.numerics.input.gltf_appearance import SurfaceAppearance


class Seamed(NamedTuple):
    """The cleaned mesh with one copy of a vertex for each texture coordinate and colour that it has.

    vertex   : (surface_vertex,) vertex of the cleaned mesh, ascending
    faces    : (face, corner) copies; the corners of each face of the cleaned mesh, in its order
    uv       : (surface_vertex, 2), or (surface_vertex, 0) where there are none
    colour   : (surface_vertex, 3), or (surface_vertex, 0) where there are none
    material : (face,)
    """

    vertex: Labels
    faces: Faces
    uv: Floats
    colour: Floats
    material: Labels


def seamed(surface: SurfaceAppearance, vertex_map: Ints, F: Ints) -> Seamed | None:
    """Brings what the corners of a file's faces look like to the faces of the cleaned mesh; None where a face has none.

    A face of the cleaned mesh is the first of the file's with the same three vertices, in any order.

    vertex_map : (input_vertex,) vertex of the cleaned mesh, −1 where it was dropped
    F          : (face, corner) of the cleaned mesh
    """
    there = vertex_map[surface.faces]
    whole = np.flatnonzero((there >= 0).all(axis=1))
    n = int(max(F.max(), there.max())) + 1
    keys, first = np.unique(_key(there[whole], n), return_index=True)
    wanted = _key(F, n)
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1) if len(keys) else np.zeros(len(F), np.int64)
    if not len(keys) or (keys[at] != wanted).any():
        return None
    face = whole[first[at]]
    corner = np.argmax(there[face][:, None, :] == F[:, :, None], axis=2)
    columns = [F[..., None].astype(np.float64)]
    columns += [values[face[:, None], corner] for values in (surface.uv, surface.colour) if values is not None]
    rows = np.concatenate(columns, axis=2)
    copies, index = np.unique(rows.reshape(-1, rows.shape[2]), axis=0, return_inverse=True)
    split = 1 if surface.uv is None else 3
    return Seamed(
        vertex=copies[:, 0].astype(np.int32),
        faces=index.reshape(-1, 3).astype(np.int32),
        uv=copies[:, 1:split],
        colour=copies[:, split:],
        material=surface.material[face].astype(np.int32),
    )


def vertex_colours(corners: Seamed, base: Floats, picture: Sequence[Floats | None]) -> Floats:
    """Colour of each vertex of the cleaned mesh, the mean over its copies and their faces (glTF 2.0, Sec. 3.9.2).

    A copy has the product of its own colour, that of the material, and the pixel of the picture that is nearest to its texture
    coordinates, which repeat.

    base    : (material, 3) linear
    picture : of each material, (row, column, 3) linear, the upper row first; None where it has none
    returns : (vertex, 3) linear; NaN where a vertex is of no face
    """
    vertex = corners.vertex[corners.faces]
    total, count = np.zeros((int(corners.vertex.max()) + 1, 3)), np.zeros(int(corners.vertex.max()) + 1)
    for k, texels in enumerate(picture):
        of_material = corners.material == k
        copies = corners.faces[of_material].ravel()
        colour = np.tile(base[k], (len(copies), 1))
        if corners.colour.shape[1]:
            colour *= corners.colour[copies]
        if texels is not None and corners.uv.shape[1]:
            rows, columns = texels.shape[:2]
            u, v = np.nan_to_num(corners.uv[copies] % 1.0).T
            colour *= texels[
                np.minimum((v * rows).astype(np.int64), rows - 1), np.minimum((u * columns).astype(np.int64), columns - 1)
            ]
        np.add.at(total, vertex[of_material].ravel(), colour)
        np.add.at(count, vertex[of_material].ravel(), 1.0)
    with np.errstate(invalid="ignore"):
        return np.asarray(total / count[:, None])


def _key(F: Ints, n: int) -> Ints:
    """(face,) a number for the three vertices of each face, whatever their order."""
    a, b, c = np.sort(F.astype(np.int64), axis=1).T
    return (a * n + b) * n + c
