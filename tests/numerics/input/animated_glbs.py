"""Animated GLBs, made by hand."""

import json
import struct

import numpy as np

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.uint16)
KINDS = {"f4": 5126, "u1": 5121, "u2": 5123, "u4": 5125, "i2": 5122}
WIDTHS = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GlbDraft:
    """A GLB with one tetrahedron, to which a test adds what it is about."""

    def __init__(self):
        self.body = b""
        self.document = {
            "asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}], "animations": [],
        }  # fmt: skip
        self.primitive = {"attributes": {"POSITION": self.add(V)}, "indices": self.add(F.reshape(-1))}
        self.document["meshes"] = [{"primitives": [self.primitive]}]

    def view(self, raw):
        self.body += b"\0" * (-len(self.body) % 4)
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": len(self.body), "byteLength": len(raw)})
        self.body += raw
        return len(self.document["bufferViews"]) - 1

    def add(self, array, **more):
        array = np.asarray(array)
        width = array.shape[1] if array.ndim > 1 else 1
        kind = KINDS[array.dtype.str[1:]]
        accessor = {"bufferView": self.view(array.tobytes()), "componentType": kind, "count": len(array), "type": WIDTHS[width]}
        self.document["accessors"].append({**accessor, **more})
        return len(self.document["accessors"]) - 1

    def moves(self, path, times, values, node=0, way="LINEAR", name="walk"):
        samplers = [{"input": self.add(np.float32(times)), "output": self.add(np.float32(values)), "interpolation": way}]
        channels = [{"sampler": 0, "target": {"node": node, "path": path}}]
        self.document["animations"].append({"name": name, "samplers": samplers, "channels": channels})
        return self

    def raw(self):
        self.document["buffers"] = [{"byteLength": len(self.body)}]
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        body = self.body + b"\0" * (-len(self.body) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(body), b"BIN\0") + body
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


TENTHS = np.arange(11) / 10
