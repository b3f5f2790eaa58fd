"""A skeleton as GLB (glTF 2.0): JSON and one block of numbers (ours).

No library writes the file, because none helps: trimesh writes no skins, and pygltflib only represents the JSON as classes. The
tests check the file with the Khronos validator.
"""

import json
import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Floats
from kinetree.schemas.results.glb import ASSUMED_FPS
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.results.formats.colours import linear, part_colours
from kinetree.tasks.results.formats.rig import children, local_offsets, local_rotations, quaternions, rest_frames, seconds

COMPONENT_TYPES = {"float32": 5126, "uint32": 5125, "uint16": 5123, "uint8": 5121}
ELEMENT_TYPES = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
VERTICES, ELEMENTS = 34962, 34963
"""Codes of the specification: types of numbers, shapes of elements, targets of buffer views."""


def gltf(skeleton: Skeleton, origin: Mapping[str, Any] | None = None) -> bytes:
    """The reference mesh skinned to the animated joints, as the bytes of a GLB file.

    Node 0 holds the joints, in the skeleton's order, and neither rotates nor scales them, because Blender reads the lengths of
    bones without what is above them. The y axis of every joint points along its bone in the reference pose.

    skeleton : with y up, in metres
    origin   : what the file tells of the input's coordinates
    """
    block = _Block()
    joints = len(skeleton.names)
    B = rest_frames(skeleton.rest, skeleton.parents)
    fps = skeleton.fps or ASSUMED_FPS
    extras = {**(origin or {}), "fps": fps, "fps_is_assumed": skeleton.fps is None, "frames": list(skeleton.frames)}
    document = {
        "asset": {"version": "2.0", "generator": "kinetree", "extras": extras},
        "scene": 0,
        "scenes": [{"nodes": [0, joints + 1]}],
        "nodes": [
            {"name": "skeleton", "children": [1]},
            *_joints(skeleton, B),
            {"name": "body", "mesh": 0, "skin": 0},
        ],
        "meshes": [{"name": "body", "primitives": [_primitive(block, skeleton)]}],
        "materials": [{"name": "parts", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8}}],
        "skins": [
            {
                "name": "skeleton",
                "skeleton": 1,
                "joints": list(range(1, joints + 1)),
                "inverseBindMatrices": block.add(_inverse_binds(skeleton.rest, B)),
            }
        ],
        "animations": [_animation(block, skeleton, B, fps)],
    }
    return _packed(document | block.json(), block.bytes)


class _Block:
    """Arrays in one buffer, each in its own view, which begins at a multiple of four bytes."""

    def __init__(self) -> None:
        self.bytes = bytearray()
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []

    def add(self, array: NDArray[Any], target: int | None = None, *, bounded: bool = False, share: bool = False) -> int:
        """Adds an array of elements and returns its accessor; with `share`, bytes mean numbers from 0 to 1."""
        element: dict[str, Any] = {"bufferView": len(self._views), "componentType": COMPONENT_TYPES[str(array.dtype)]}
        element |= {"count": len(array), "type": ELEMENT_TYPES[array.shape[1:]]}
        if bounded:
            rows = array.reshape(len(array), -1)
            element |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        view = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": array.nbytes}
        self._views.append(view | ({"target": target} if target else {}))
        self._accessors.append(element | ({"normalized": True} if share else {}))
        self.bytes += np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
        self.bytes += bytes(-len(self.bytes) % 4)
        return len(self._accessors) - 1

    def json(self) -> dict[str, Any]:
        """The block's part of the document."""
        return {"accessors": self._accessors, "bufferViews": self._views, "buffers": [{"byteLength": len(self.bytes)}]}


def _joints(skeleton: Skeleton, B: Floats) -> list[dict[str, Any]]:
    """The nodes of the joints in the reference pose."""
    offsets = local_offsets(skeleton.rest, B, skeleton.parents)
    identity = np.broadcast_to(np.eye(3), (1, len(B), 3, 3))
    rotations = quaternions(local_rotations(identity, B, skeleton.parents))[0]
    nodes: list[dict[str, Any]] = []
    for joint, below in enumerate(children(skeleton.parents)):
        node = {"name": skeleton.names[joint], "translation": offsets[joint].tolist(), "rotation": rotations[joint].tolist()}
        nodes.append(node | ({"children": [c + 1 for c in below]} if below else {}))
    return nodes


def _primitive(block: _Block, skeleton: Skeleton) -> dict[str, Any]:
    """The reference mesh with normals, part colours and skinning weights."""
    V = skeleton.vertices.astype(np.float32)
    N = smoothed_normals(skeleton.vertices, skeleton.faces, rounds=0)
    N[np.linalg.norm(N, axis=1) == 0] = (0.0, 0.0, 1.0)
    rgb = np.rint(255 * linear(part_colours(skeleton.label, skeleton.faces)))
    colour = np.concatenate([rgb, np.full((len(rgb), 1), 255.0)], axis=1).astype(np.uint8)[skeleton.label]
    joint, weight = influences(skeleton)
    attributes = {
        "POSITION": block.add(V, VERTICES, bounded=True),
        "NORMAL": block.add(N.astype(np.float32), VERTICES),
        "COLOR_0": block.add(colour, VERTICES, share=True),
        "JOINTS_0": block.add(joint, VERTICES),
        "WEIGHTS_0": block.add(weight, VERTICES),
    }
    return {"attributes": attributes, "indices": block.add(skeleton.faces.astype(np.uint32).ravel(), ELEMENTS), "material": 0}


def influences(skeleton: Skeleton) -> tuple[NDArray[Any], NDArray[np.float32]]:
    """Joints and weights of every vertex as glTF requires them.

    returns : (vertex, 4) joints, 0 where the weight is 0; (vertex, 4) weights, which sum to 1 as 32-bit floats
    """
    weight = skeleton.weight.astype(np.float32)
    weight[:, 0] = 1.0 - weight[:, 1:].sum(axis=1, dtype=np.float32)
    integer = np.uint8 if len(skeleton.names) <= 256 else np.uint16
    return np.where(weight > 0, skeleton.influence, 0).astype(integer), weight


def _inverse_binds(rest: Floats, B: Floats) -> NDArray[np.float32]:
    """(joint, 4, 4) transformation from the reference mesh to each joint, columns first as in glTF."""
    M = np.tile(np.eye(4), (len(rest), 1, 1))
    M[:, :3, :3] = B  # columns first: the transpose of Bᵀ
    M[:, 3, :3] = -np.einsum("jyx,jy->jx", B, rest)
    return M.astype(np.float32)


def _animation(block: _Block, skeleton: Skeleton, B: Floats, fps: float) -> dict[str, Any]:
    """The translation of the root and the rotation of every joint over time."""
    times = block.add(seconds(skeleton, fps).astype(np.float32), bounded=True)
    rotations = quaternions(local_rotations(skeleton.rotation, B, skeleton.parents)).astype(np.float32)
    curves = [(0, "translation", skeleton.positions[:, 0].astype(np.float32))]
    curves += [(j, "rotation", rotations[:, j]) for j, kind in enumerate(skeleton.kinds) if kind != "leaf"]
    return {
        "name": "motion",
        "samplers": [{"input": times, "output": block.add(values), "interpolation": "LINEAR"} for _, _, values in curves],
        "channels": [{"sampler": n, "target": {"node": j + 1, "path": path}} for n, (j, path, _) in enumerate(curves)],
    }


def _packed(document: dict[str, Any], block: Sequence[int]) -> bytes:
    """The container: a header, the JSON chunk, the binary chunk."""
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=True, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(block), b"BIN\0") + bytes(block)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
