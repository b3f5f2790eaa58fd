"""Texture coordinates, colours and textures of a GLB (Khronos Group, glTF 2.0 Specification, Sec. 3.7.2 and 3.9)."""

import base64
from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
from trimesh.exchange.gltf import load_glb

from kinetree.errors import SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats, Ints
from kinetree.tasks.numerics.input.gltf import Gltf
from kinetree.tasks.numerics.input.pictures import Picture, picture

_TRIANGLES = 4
_MOST_PRIMITIVES = 100_000


class Material(NamedTuple):
    """A name, a colour (linear r, g, b, a from 0 to 1), and the picture that it is multiplied with."""

    name: str
    colour: tuple[float, ...]
    picture: int | None


class SurfaceAppearance(NamedTuple):
    """What one frame's surface looks like, by the corners of its faces.

    faces     : (face, corner) vertices
    uv        : (face, corner, 2) texture coordinates from the picture's upper left; None where there are none
    colour    : (face, corner, rgb) linear, 0 to 1; None where there are none
    material  : (face,) which of `materials`
    missing   : sentences on what is named and could not be had
    """

    faces: Ints
    uv: Floats | None
    colour: Floats | None
    material: Ints
    materials: tuple[Material, ...]
    pictures: tuple[Picture, ...]
    missing: tuple[str, ...]


def glb_appearance(raw: bytes, F: Faces, moves: bool) -> SurfaceAppearance | None:
    """The appearance of a GLB; None where it has none.

    F      : (face, corner) as its surface is read
    moves  : whether it was read as an animation
    raises : SourceError where it is damaged, or shows other faces
    """
    gltf = Gltf.of(raw)
    primitives = _as_animated(gltf) if moves else _as_scene(gltf, raw)
    if sum(_count(gltf, p) for p in primitives) != F.size:
        raise SourceError("shows other faces than its surface has")
    pictures, at, missing = _pictures(gltf)
    materials = [Material("body", (1.0, 1.0, 1.0, 1.0), None), *(_material(gltf, m, at) for m in gltf.items("materials"))]
    faces, uv, colour, material, begin, face = [], [], [], [], 0, 0
    has_uv, has_colour = (any(name in p.get("attributes", {}) for p in primitives) for name in ("TEXCOORD_0", "COLOR_0"))
    for primitive in primitives:
        attributes = primitive["attributes"]
        n = len(gltf.array(attributes["POSITION"]))
        own = gltf.array(primitive["indices"]).astype(np.int64) if "indices" in primitive else np.arange(n)
        own = own.reshape(-1, 3)
        if (own + begin != F[face : face + len(own)]).any():
            own = own[:, ::-1]  # a mirror turned the corners of its faces
        faces.append(own + begin)
        uv.append(_rows(gltf, attributes.get("TEXCOORD_0"), n, (0.0, 0.0))[own])
        colour.append(_rows(gltf, attributes.get("COLOR_0"), n, (1.0, 1.0, 1.0))[own])
        material.append(np.full(len(own), primitive.get("material", -1) + 1))
        begin, face = begin + n, face + len(own)
    if not (has_uv or has_colour or len(materials) > 1):
        return None
    return SurfaceAppearance(
        np.concatenate(faces), np.concatenate(uv) if has_uv else None, np.concatenate(colour) if has_colour else None,
        np.concatenate(material), tuple(materials), tuple(pictures), tuple(missing),
    )  # fmt: skip


Primitives = Sequence[Mapping[str, Any]]
"""Primitives in the order in which a surface is made of them."""


def _as_animated(gltf: Gltf) -> Primitives:
    """As `AnimatedGlb` reads them: nodes of the scene, the last first."""
    nodes = gltf.items("nodes")
    below = {c for node in nodes for c in node.get("children", [])}
    scenes = gltf.items("scenes")
    roots = gltf.item("scenes", gltf.document.get("scene", 0)).get("nodes", []) if scenes else set(range(len(nodes))) - below
    waiting, primitives = list(roots), list[Mapping[str, Any]]()
    while waiting and len(primitives) < _MOST_PRIMITIVES:
        node = gltf.item("nodes", waiting.pop())
        mesh = gltf.item("meshes", node["mesh"]) if "mesh" in node else {}
        primitives += [p for p in mesh.get("primitives", []) if p.get("mode", _TRIANGLES) == _TRIANGLES]
        waiting += node.get("children", [])
    return primitives


def _as_scene(gltf: Gltf, raw: bytes) -> Primitives:
    """As `formats` reads a GLB without motion: geometries by name, placed as trimesh's graph says."""
    scene = load_glb(BytesIO(raw), resolver=None, skip_materials=True)
    triangles = {key for key, mesh in scene["geometry"].items() if "faces" in mesh}
    primitives = [p for mesh in gltf.items("meshes") for p in mesh.get("primitives", []) if p.get("mode", _TRIANGLES) < 6]
    if len(primitives) != len(scene["geometry"]):
        return ()
    of = dict(zip(scene["geometry"], primitives, strict=True))
    named = [edge.get("geometry") for edge in scene["graph"]] if scene["graph"] else list(scene["geometry"])
    return [of[key] for key in named if key in triangles]


def _count(gltf: Gltf, primitive: Mapping[str, Any]) -> int:
    """Corners of a primitive's triangles."""
    accessor = primitive.get("indices", primitive.get("attributes", {}).get("POSITION"))
    return int(gltf.item("accessors", accessor).get("count", 0))


def _rows(gltf: Gltf, accessor: Any, n: int, default: tuple[float, ...]) -> Floats:
    """(n, len(default)) an attribute; the default where there is none."""
    if accessor is None:
        return np.tile(default, (n, 1))
    rows = gltf.array(accessor)
    if rows.ndim != 2 or len(rows) != n or rows.shape[1] < len(default):
        raise SourceError(f"accessor {accessor} has not a row for every vertex; the file is damaged")
    return np.asarray(rows[:, : len(default)])


def _pictures(gltf: Gltf) -> tuple[list[Picture], dict[int, int], list[str]]:
    """All pictures that can be had, the place of each by its number in the file, and what could not be had."""
    pictures: list[Picture] = []
    at: dict[int, int] = {}
    missing = []
    for i, image in enumerate(gltf.items("images")):
        raw = _bytes(gltf, image)
        texture = picture(raw) if raw is not None else "lies outside the file"
        if isinstance(texture, str):
            missing.append(f"picture {image.get('name', i)}: {texture}")
        else:
            at[i] = len(pictures)
            pictures.append(texture)
    return pictures, at, missing


def _bytes(gltf: Gltf, image: Mapping[str, Any]) -> bytes | None:
    """The bytes of a picture in the file's own block or in its JSON; None where they are elsewhere."""
    if "bufferView" in image:
        view = gltf.item("bufferViews", image["bufferView"])
        begin, size = int(view.get("byteOffset", 0)), int(view.get("byteLength", 0))
        return gltf.binary[begin : begin + size] if 0 <= begin <= begin + size <= len(gltf.binary) else b""
    uri = str(image.get("uri", ""))
    return base64.b64decode(uri.partition(",")[2]) if uri.startswith("data:") else None


def _material(gltf: Gltf, material: Mapping[str, Any], at: Mapping[int, int]) -> Material:
    """The base colour of one material."""
    pbr = material.get("pbrMetallicRoughness", {})
    texture = pbr.get("baseColorTexture", {}).get("index")
    source = None if texture is None else gltf.item("textures", texture).get("source")
    colour = np.clip([float(c) for c in pbr.get("baseColorFactor", (1, 1, 1, 1))], 0.0, 1.0)
    return Material(str(material.get("name", "body")), tuple(colour.tolist()), None if source is None else at.get(source))
