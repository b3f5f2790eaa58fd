"""A reader and evaluator of GLB files, written from the specification and from nothing in kinetree."""

import json
import struct
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
DTYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Glb:
    """One file with one skinned mesh and one animation."""

    def __init__(self, data: bytes) -> None:
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON"
        self.json: dict[str, Any] = json.loads(data[20 : 20 + size])
        binary, kind = struct.unpack_from("<I4s", data, 20 + size)
        assert kind == b"BIN\0"
        assert 28 + size + binary == len(data)
        self.buffer = data[28 + size :]

    def array(self, accessor: int) -> npt.NDArray[Any]:
        """The numbers of one accessor, one row an element."""
        description = self.json["accessors"][accessor]
        view = self.json["bufferViews"][description["bufferView"]]
        width = WIDTHS[description["type"]]
        flat = np.frombuffer(
            self.buffer, DTYPES[description["componentType"]], description["count"] * width, view["byteOffset"]
        )
        return flat.reshape(-1, width) if width > 1 else flat

    def attribute(self, name: str) -> npt.NDArray[Any]:
        """One attribute of the mesh."""
        return self.array(self.json["meshes"][0]["primitives"][0]["attributes"][name])

    @property
    def faces(self) -> npt.NDArray[Any]:
        """(face, corner)."""
        return self.array(self.json["meshes"][0]["primitives"][0]["indices"]).reshape(-1, 3)

    @property
    def joints(self) -> list[int]:
        """The nodes that are joints, in the skin's order."""
        return list(self.json["skins"][0]["joints"])

    @property
    def names(self) -> list[str]:
        """Of the joints."""
        return [self.json["nodes"][n]["name"] for n in self.joints]

    @cached_property
    def parent(self) -> dict[int, int]:
        """Of every node that has one."""
        return {child: n for n, node in enumerate(self.json["nodes"]) for child in node.get("children", ())}

    @cached_property
    def times(self) -> Floats:
        """Of the keys, which all channels share."""
        inputs = {s["input"] for s in self.json["animations"][0]["samplers"]}
        assert len(inputs) == 1
        return self.array(inputs.pop()).astype(np.float64)

    def pose(self, key: int | None = None) -> Floats:
        """(joint, 4, 4) into the scene at a key of the animation, or at rest."""
        nodes = [{**node} for node in self.json["nodes"]]
        for channel in self.json["animations"][0]["channels"] if key is not None else ():
            sampler = self.json["animations"][0]["samplers"][channel["sampler"]]
            assert sampler["interpolation"] == "LINEAR"
            nodes[channel["target"]["node"]][channel["target"]["path"]] = self.array(sampler["output"])[key]
        return np.stack([self._into_scene(nodes, n) for n in self.joints])

    def skinned(self, key: int | None = None) -> Floats:
        """(vertex, xyz) the mesh in the scene."""
        inverse = self.array(self.json["skins"][0]["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        M = self.pose(key) @ inverse
        V = np.column_stack([self.attribute("POSITION"), np.ones(len(self.attribute("POSITION")))]).astype(np.float64)
        moved = np.einsum("vixy,vy->vix", M[self.attribute("JOINTS_0")], V)
        return np.asarray(np.einsum("vi,vix->vx", self.attribute("WEIGHTS_0").astype(np.float64), moved)[:, :3])

    def _into_scene(self, nodes: list[dict[str, Any]], n: int) -> Floats:
        M = np.eye(4)
        M[:3, :3] = _matrix(nodes[n].get("rotation", (0, 0, 0, 1))) * np.array(nodes[n].get("scale", (1, 1, 1)))
        M[:3, 3] = nodes[n].get("translation", (0, 0, 0))
        return self._into_scene(nodes, self.parent[n]) @ M if n in self.parent else M


def _matrix(quaternion: Any) -> Floats:
    x, y, z, w = np.asarray(quaternion, np.float64)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
