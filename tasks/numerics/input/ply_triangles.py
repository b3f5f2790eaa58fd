"""Faces of a PLY as most programs write it, read without trimesh: a plan would wait for its import, a text take its memory."""

import re
from array import array
from itertools import islice

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.input.polygons import triangles_of
from kinetree.tasks.numerics.input.text_lines import text_lines

_SCALARS = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
    "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4",
    "double": "<f8", "float64": "<f8",
}  # fmt: skip
_VERTEX = re.compile(r"element vertex (\d{1,10})((?:\nproperty \w+ \w+)+)")
_FACE = re.compile(r"element face (\d{1,10})\nproperty list (?:uchar|uint8) (int|int32|uint|uint32) vertex_ind(?:ices|ex)")
_WHOLE = f"(?:{'|'.join(name for name, code in _SCALARS.items() if 'f' not in code)})"
_POLYGONS = re.compile(rf"\nelement face (\d{{1,10}})\nproperty list {_WHOLE} {_WHOLE} vertex_ind(?:ices|ex)(?:\n|$)")


def binary_triangles(header: bytes, body: bytes) -> tuple[Floats, Ints] | None:
    """Vertices and faces of a little-endian file of vertices, then triangles, and nothing else; None of every other file.

    header, body : what stands before and after "end_header"
    returns      : (vertex, xyz) in the file's unit · (face, corner)
    """
    form, rest = _claims(header)
    vertex, face = _VERTEX.match(rest), _FACE.search(rest)
    if form != "format binary_little_endian 1.0" or not vertex or not face or f"{vertex[0]}\n{face[0]}" != rest:
        return None
    properties = _properties(vertex[2])
    if properties is None:
        return None
    point = np.dtype(list(properties.items()))
    triangle = np.dtype([("corners", "u1"), ("face", _SCALARS[face[2]], 3)])
    n, m = int(vertex[1]), int(face[1])
    if not body.startswith(b"\n") or len(body) != 1 + n * point.itemsize + m * triangle.itemsize:
        return None
    points, triangles = np.frombuffer(body, point, n, 1), np.frombuffer(body, triangle, m, 1 + n * point.itemsize)
    if (triangles["corners"] != 3).any():
        return None
    return np.stack([points[axis].astype(np.float64) for axis in "xyz"], axis=1), triangles["face"].astype(np.int64)


def text_polygons(header: bytes, body: bytes) -> tuple[Floats, Ints] | None:
    """Vertices and faces of a text of vertices, then polygons, then anything else; None of every other file.

    header, body : what stands before and after "end_header", the rows as the header claims them
    returns      : (vertex, xyz) in the file's unit · (face, corner), polygons cut as trimesh does it
    """
    form, rest = _claims(header)
    vertex = _VERTEX.match(rest)
    face = _POLYGONS.match(rest, vertex.end()) if vertex else None
    properties = _properties(vertex[2]) if vertex else None
    if form != "format ascii 1.0" or not vertex or not face or properties is None or not int(vertex[1]) * int(face[1]):
        return None
    if any(properties[axis] not in ("<f4", "<f8") for axis in "xyz"):
        return None
    x, y, z = (list(properties).index(axis) for axis in "xyz")
    places, corners, counts = array("d"), array("q"), array("q")
    rows = (words for line in text_lines(body) if (words := line.split()))
    for words in islice(rows, int(vertex[1])):
        places.extend((float(words[x]), float(words[y]), float(words[z])))
    for words in islice(rows, int(face[1])):
        counts.append(int(words[0]))
        corners.extend([int(word) for word in words[1 : 1 + counts[-1]]])
    V = np.asarray(places).reshape(-1, 3)
    for k, axis in enumerate("xyz"):
        V[:, k] = V[:, k].astype(properties[axis])
    return V, triangles_of(corners, counts)[0]


def _claims(header: bytes) -> tuple[str, str]:
    """The line of the format, and those after it, without remarks."""
    lines = [" ".join(line.split()) for line in header.decode("ascii", "replace").split("\n")]
    text = "\n".join(line for line in lines if line and not line.startswith(("comment", "obj_info")))
    form, _, rest = text.removeprefix("ply\n").partition("\n")
    return form, rest


def _properties(lines: str) -> dict[str, str] | None:
    """The properties of vertices and their types; None where one is of no known type or named twice, or places are missing."""
    properties = [line.split()[1:] for line in lines.strip().split("\n")]
    names = {name for _, name in properties}
    if any(kind not in _SCALARS for kind, _ in properties) or len(names) < len(properties) or not {"x", "y", "z"} <= names:
        return None
    return {name: _SCALARS[kind] for kind, name in properties}
