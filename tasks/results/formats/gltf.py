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

from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.results.appearance import Appearance, SurfaceMaterial
from kinetree.schemas.results.glb import ASSUMED_FPS
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.results.formats.colours import linear, part_colours
from kinetree.tasks.results.formats.rig import children, local_offsets, local_rotations, quaternions, rest_frames, seconds

COMPONENT_TYPES = {"float32": 5126, "uint32": 5125, "uint16": 5123, "uint8": 5121}
ELEMENT_TYPES = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
VERTICES, ELEMENTS = 34962, 34963
"""Codes of the specification: types of numbers, shapes of elements, targets of buffer views."""


def gltf(skeleton: Skeleton, origin: Mapping[str, Any] | None = None, appearance: Appearance | None = None) -> bytes:
    """The reference mesh skinned to the animated joints, as the bytes of a GLB file.

    Node 0 holds the joints, in the skeleton's order, and neither rotates nor scales them, because Blender reads the lengths of
    bones without what is above them. The y axis of every joint points along its bone in the reference pose.

    skeleton   : with y up, in metres
    origin     : what the file tells of the input's coordinates
    appearance : textures and colours of the input; parts are coloured where there is none, or it has no frame
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
        **(
            _mesh_of_parts(block, skeleton)
            if appearance is None or appearance.frame is None
            else _mesh_of_input(block, skeleton, appearance)
        ),
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
        self._accessors.append(element | ({"normalized": True} if share else {}))
        self.put(np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes(), target)
        return len(self._accessors) - 1

    def put(self, raw: bytes, target: int | None = None) -> int:
        """Adds bytes and returns their view."""
        view = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(raw)}
        self._views.append(view | ({"target": target} if target else {}))
        self.bytes += raw + bytes(-len(raw) % 4)
        return len(self._views) - 1

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


def _mesh_of_parts(block: _Block, skeleton: Skeleton) -> dict[str, Any]:
    """The reference mesh in the colours of its parts."""
    rgb = np.rint(255 * linear(part_colours(skeleton.label, skeleton.faces)))
    colour = np.concatenate([rgb, np.full((len(rgb), 1), 255.0)], axis=1).astype(np.uint8)[skeleton.label]
    every = np.arange(len(skeleton.vertices), dtype=np.int32)
    attributes = _attributes(block, skeleton, every) | {"COLOR_0": block.add(colour, VERTICES, share=True)}
    indices = block.add(skeleton.faces.astype(np.uint32).ravel(), ELEMENTS)
    return {
        "meshes": [{"name": "body", "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}],
        "materials": [_material("parts")],
    }


def _mesh_of_input(block: _Block, skeleton: Skeleton, appearance: Appearance) -> dict[str, Any]:
    """The reference mesh with the texture coordinates, textures and colours of its file, a primitive for each material."""
    attributes = _attributes(block, skeleton, np.array(appearance.vertex))
    if appearance.has_uv:
        attributes["TEXCOORD_0"] = block.add(appearance.uv.astype(np.float32), VERTICES)
    if appearance.has_colour:
        rgba = np.concatenate([appearance.colour, np.ones((len(appearance.colour), 1))], axis=1)
        attributes["COLOR_0"] = block.add(np.rint(65535 * np.clip(rgba, 0, 1)).astype(np.uint16), VERTICES, share=True)
    used = np.unique(appearance.material).tolist()
    pictures = sorted(
        {m.picture for m in (appearance.materials[k] for k in used) if m.picture is not None and appearance.has_uv}
    )
    primitives = []
    for n, k in enumerate(used):
        indices = appearance.faces[appearance.material == k].astype(np.uint32).ravel()
        primitives.append({"attributes": attributes, "indices": block.add(indices, ELEMENTS), "material": n})
    content, ends = appearance.content.tobytes(), np.cumsum(appearance.sizes)
    document = {
        "meshes": [{"name": "body", "primitives": primitives}],
        "materials": [_textured(appearance.materials[k], pictures) for k in used],
    }
    if not pictures:
        return document
    contents = [content[ends[i] - appearance.sizes[i] : ends[i]] for i in pictures]
    images = [
        {"bufferView": block.put(raw), "mimeType": appearance.media[i]} for i, raw in zip(pictures, contents, strict=True)
    ]
    return document | {"textures": [{"source": n} for n in range(len(images))], "images": images}


def _textured(material: SurfaceMaterial, pictures: Sequence[int]) -> dict[str, Any]:
    """A material of the input."""
    more: dict[str, Any] = {} if material.colour == (1.0, 1.0, 1.0, 1.0) else {"baseColorFactor": list(material.colour)}
    if material.picture in pictures:
        more["baseColorTexture"] = {"index": pictures.index(material.picture)}
    return _material(material.name, **more)


def _material(name: str, **more: Any) -> dict[str, Any]:
    """A material that does not shine."""
    return {"name": name, "pbrMetallicRoughness": {**more, "metallicFactor": 0.0, "roughnessFactor": 0.8}}


def _attributes(block: _Block, skeleton: Skeleton, vertex: Ints) -> dict[str, int]:
    """Positions, normals and skinning weights of some vertices of the reference mesh, in this order."""
    N = smoothed_normals(skeleton.vertices, skeleton.faces, rounds=0)
    N[np.linalg.norm(N, axis=1) == 0] = (0.0, 0.0, 1.0)
    joint, weight = influences(skeleton)
    return {
        "POSITION": block.add(skeleton.vertices[vertex].astype(np.float32), VERTICES, bounded=True),
        "NORMAL": block.add(N[vertex].astype(np.float32), VERTICES),
        "JOINTS_0": block.add(joint[vertex], VERTICES),
        "WEIGHTS_0": block.add(weight[vertex], VERTICES),
    }


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
