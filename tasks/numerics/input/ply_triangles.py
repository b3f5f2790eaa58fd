"""Triangles of a binary PLY as most programs write it, read without trimesh, whose import a plan would wait for."""

import re

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints

_SCALARS = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
    "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4",
    "double": "<f8", "float64": "<f8",
}  # fmt: skip
_VERTEX = re.compile(r"element vertex (\d{1,10})((?:\nproperty \w+ \w+)+)")
_FACE = re.compile(r"element face (\d{1,10})\nproperty list (?:uchar|uint8) (int|int32|uint|uint32) vertex_ind(?:ices|ex)")


def binary_triangles(header: bytes, body: bytes) -> tuple[Floats, Ints] | None:
    """Vertices and faces of a little-endian file of vertices, then triangles, and nothing else; None of every other file.

    header, body : what stands before and after "end_header"
    returns      : (vertex, xyz) in the file's unit · (face, corner)
    """
    lines = [" ".join(line.split()) for line in header.decode("ascii", "replace").split("\n")]
    text = "\n".join(line for line in lines if line and not line.startswith(("comment", "obj_info")))
    form, _, rest = text.removeprefix("ply\n").partition("\n")
    vertex, face = _VERTEX.match(rest), _FACE.search(rest)
    if form != "format binary_little_endian 1.0" or not vertex or not face or f"{vertex[0]}\n{face[0]}" != rest:
        return None
    properties = [line.split()[1:] for line in vertex[2].strip().split("\n")]
    names = [name for _, name in properties]
    if any(kind not in _SCALARS for kind, _ in properties) or len(set(names)) < len(names) or not {"x", "y", "z"} <= {*names}:
        return None
    point = np.dtype([(name, _SCALARS[kind]) for kind, name in properties])
    triangle = np.dtype([("corners", "u1"), ("face", _SCALARS[face[2]], 3)])
    n, m = int(vertex[1]), int(face[1])
    if not body.startswith(b"\n") or len(body) != 1 + n * point.itemsize + m * triangle.itemsize:
        return None
    points, triangles = np.frombuffer(body, point, n, 1), np.frombuffer(body, triangle, m, 1 + n * point.itemsize)
    if (triangles["corners"] != 3).any():
        return None
    return np.stack([points[axis].astype(np.float64) for axis in "xyz"], axis=1), triangles["face"].astype(np.int64)
