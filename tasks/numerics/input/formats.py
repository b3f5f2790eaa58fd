"""Mesh files of the six formats that are read, and what is refused of them.

A file is input from outside: every count it claims is held against its size before memory is taken, nothing outside it
is opened, and whatever cannot be a mesh is refused with its name and the reason.
"""

import json
import re
from array import array
from collections.abc import Callable
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from kinetree.errors import MeshError, SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats, Ints
from kinetree.tasks.numerics.input import draco
from kinetree.tasks.numerics.input.gltf import Gltf
from kinetree.tasks.numerics.input.gltf_size import unfolded_bytes
from kinetree.tasks.numerics.input.ply_rows import elements, lines, refuse_wrong_faces, refuse_wrong_rows
from kinetree.tasks.numerics.input.ply_triangles import binary_triangles, text_polygons
from kinetree.tasks.numerics.input.polygons import triangles_of
from kinetree.tasks.numerics.input.text_lines import text_lines
from kinetree.tasks.numerics.input.unpacked import bomb, too_large

MOST_BYTES = 2**31
"""Of one mesh as a file: fifty million vertices and twice as many faces in binary."""
_MOST_VERTICES = 50_000_000  # a small GLB may place one mesh any number of times; no frame of a body comes near this
_MOST_FACES = 2 * _MOST_VERTICES
_MOST_UNUSUAL_BYTES = 2**26
"""Of a PLY's text that trimesh reads, which takes up to 75 times as many of memory."""
_COARSEST = 1e-3
"""Share of the body's diagonal by which coordinates may go up in steps; such steps are noise of 0.03 %. Not varied so far."""
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_ENCODED = {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization"}


def read_mesh(path: Path | str) -> tuple[Floats, Faces]:
    """One mesh, its vertices exactly those of the file and in the file's order.

    STL has three vertices a face; the meshes of a GLB follow each other, placed as its scene says; polygons become
    triangles as trimesh does it. Textures, materials and other files named in the file are not opened.

    returns : V (vertex, xyz) in the file's unit · F (face, corner)
    raises  : MeshError if it cannot be read, has no faces, or its indices or coordinates are no mesh's
    """
    path = Path(path)
    if path.suffix.lower() not in _READERS:
        raise MeshError(f"{path}: {path.suffix or 'no suffix'} is not read; {' '.join(suffixes())} are")
    if not path.is_file():
        raise MeshError(f"{path}: {'not a file' if path.exists() else 'there is no such file'}")
    try:
        if why := too_large(path, MOST_BYTES):
            raise MeshError(f"{path}: {why}; is it one mesh?")
        raw = path.read_bytes()
    except OSError as error:
        raise MeshError(f"{path}: cannot be read: {error.strerror}") from None
    return mesh_of(raw, str(path), path.suffix)


def mesh_of(raw: bytes, name: str, suffix: str) -> tuple[Floats, Faces]:
    """One mesh from the bytes of a file, as `read_mesh`.

    name   : what messages call it
    suffix : of the format, one of `suffixes()`
    """
    try:
        if not raw:
            raise MeshError("the file is empty")
        V, F = _READERS[suffix.lower()](raw.removeprefix(_BYTE_ORDER_MARK))
        V = np.asarray(V, dtype=np.float64).reshape(len(V), 3)
    except (MeshError, SourceError) as error:
        raise MeshError(f"{name}: {error}") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {error}".replace(": b'", ": '")  # a word of the file, read as bytes
        raise MeshError(
            f"{name}: cannot be read as {suffix[1:].upper()} ({reason}); the file is damaged or cut short"
        ) from error
    return checked(V, F, name, first_index=int(suffix.lower() == ".obj"))


def checked(V: Any, F: Any, name: str, first_index: int = 0) -> tuple[Floats, Faces]:
    """The mesh as contiguous float64 and int32, if it is one.

    V, F        : (vertex, xyz) · (face, corner), numbers of any kind
    name        : what messages call the mesh
    first_index : what its format calls the first vertex, so that messages show the file's own numbers
    raises      : MeshError if either is empty, an index has no vertex, or a coordinate is not finite
    """
    V, F = np.ascontiguousarray(V, dtype=np.float64), np.asarray(F)
    if not len(V):
        raise MeshError(f"{name}: no vertices; the file is damaged or holds no mesh")
    if not len(F):
        raise MeshError(
            f"{name}: no faces, only {len(V)} vertices; a surface is needed, not a point cloud: mesh the points first"
        )
    wrong = (F < 0) | (len(V) <= F)
    if wrong.any():
        face, corner = np.argwhere(wrong)[0]
        remedy = "the file is damaged" + ("" if first_index else " or its indices start at 1")
        raise MeshError(
            f"{name}: vertex {corner} of face {face} is {int(F[face, corner]) + first_index}, "
            f"but the mesh has {len(V)} vertices; {remedy}"
        )
    lost = ~np.isfinite(V).all(axis=1)
    if lost.any():
        at = int(np.flatnonzero(lost)[0])
        raise MeshError(f"{name}: {lost.sum()} of {len(V)} vertices are NaN or infinite, the first is vertex {at}, {V[at]}")
    _refuse_coarse(V, F, name)
    return V, np.ascontiguousarray(F, dtype=np.int32)


def suffixes() -> tuple[str, ...]:
    """The endings of the files that are read."""
    return tuple(_READERS)


def _refuse_coarse(V: Floats, F: Any, name: str) -> None:
    """Refuses a body so far from the origin that the digits of its coordinates are used up by the distance."""
    is_corner = np.zeros(len(V), dtype=bool)
    is_corner[F.ravel()] = True
    corners = V[is_corner]
    low, high = corners.min(axis=0), corners.max(axis=0)
    farthest = float(max(-low.min(), high.max()))
    with np.errstate(over="ignore"):
        diagonal = float(np.linalg.norm(high - low))
        is_single = bool((V.astype(np.float32) == V).all())
        step = float(np.spacing(np.float32(farthest) if is_single else farthest))
    if step > _COARSEST * diagonal > 0:
        raise MeshError(
            f"{name}: its coordinates reach {farthest:.3g}, where they go up in steps of {step:.2g}, but the body is only"
            f" {diagonal:.3g} across; move the body to the origin before it is saved"
        )


def _triangles(polygons: Any) -> Ints:
    """(face, corner)"""
    from trimesh.geometry import triangulate_quads

    return np.asarray(triangulate_quads(polygons), dtype=np.int64).reshape(-1, 3)


def _ply(raw: bytes) -> tuple[Any, Any]:
    header, end, body = raw.partition(b"end_header")
    if not raw.startswith(b"ply") or not end:
        raise MeshError("no PLY header from 'ply' to 'end_header'; the file is damaged or something else")
    rows = elements(header)
    claimed = {element.name: element.rows for element in rows}
    for key, n in claimed.items():
        if not 0 <= n <= len(body):
            raise MeshError(f"its header claims {n} × {key} in {len(body)} bytes; the file is damaged or cut short")
    if len(claimed) < len(rows):
        raise MeshError("its header has two elements of one name; the file is damaged, export it again")
    if re.search(rb"^\s*format\s+ascii", header, re.MULTILINE):
        refuse_wrong_rows(rows, body)
        if (polygons := text_polygons(header, body)) is not None:
            return polygons
        if len(body) > _MOST_UNUSUAL_BYTES:
            size = f"{len(body)} bytes of text in an unusual layout, more than {_MOST_UNUSUAL_BYTES}"
            raise MeshError(f"{size}; save it as binary")
    elif (triangles := binary_triangles(header, body)) is not None:
        return triangles
    from trimesh.exchange.ply import load_ply

    try:
        mesh = load_ply(BytesIO(raw), skip_materials=True, fix_texture=False)
    except ValueError as error:
        raise MeshError(
            f"cannot be read as PLY ({error}); the file is damaged or cut short, or is binary and mixes triangles with "
            "larger polygons: triangulate it when exporting, or save it as ASCII"
        ) from error
    refuse_wrong_faces(mesh.get("metadata", {}).get("_ply_raw", {}).get("face", {}))
    V, F = mesh.get("vertices", ()), _triangles(mesh.get("faces", ()))
    for key, whole_rows in (("vertex", len(V)), ("face", len(F))):
        if whole_rows < claimed.get(key, 0):
            raise MeshError(f"its header claims {claimed[key]} × {key}, only {whole_rows} are whole; the file is cut short")
    return V, F


def _obj(raw: bytes) -> tuple[Any, Any]:
    places, corners, counts = array("d"), array("q"), array("q")
    for line in text_lines(raw, are_continued=True):
        if line.startswith((b"v ", b"v\t")):
            x, y, z = line.split(None, 4)[1:4]
            places.extend((float(x), float(y), float(z)))
        elif line.startswith((b"f ", b"f\t")):
            vertices, own = len(places) // 3, [int(word.partition(b"/")[0]) for word in line.split()[1:]]
            if len(own) < 3:
                raise MeshError(f"face {len(counts)} has {len(own)} corners; the file is damaged, export it again")
            # a negative index counts back from the vertices read so far
            corners.extend([i + vertices if i < 0 else i - 1 for i in own])
            counts.append(len(own))
    return np.asarray(places).reshape(-1, 3), triangles_of(corners, counts)[0]


def _off(raw: bytes) -> tuple[Any, Any]:
    rows = (words for line in text_lines(raw) if (words := line.partition(b"#")[0].split()))
    first = next(rows, [b""])
    if not re.fullmatch(b"(ST)?C?N?OFF", first[0].upper()) or b"BINARY" in first:
        raise MeshError("does not begin with OFF and numbers as text; the file is damaged or something else")
    n, m = (int(word) for word in (first[1:] or next(rows, []))[:2])
    follow = sum(bool(line.partition(b"#")[0].strip()) for line in text_lines(raw)) - (1 if len(first) > 1 else 2)
    if n < 0 or m < 0 or n + m > follow:
        raise MeshError(f"claims {n} vertices and {m} faces, but {follow} lines follow; the file is cut short")
    if more := follow - n - m:
        raise MeshError(f"{lines(more)} after the {n + m} that it claims: something would be left out; export it again")
    places, corners, counts = array("d"), array("q"), array("q")
    for x, y, z, *_ in islice(rows, n):
        places.extend((float(x), float(y), float(z)))
    for i, words in enumerate(rows):
        own = _polygon(i, words)
        corners.extend(own)
        counts.append(len(own))
    return np.asarray(places).reshape(n, 3), triangles_of(corners, counts)[0]


def _polygon(i: int, words: list[bytes]) -> list[int]:
    """Corners of face i of an OFF file; colours may follow them."""
    count, corners = int(words[0]), [int(word) for word in words[1:4]]
    if count < 3 or count > len(words) - 1:
        had = f"has {count} corners" if 0 <= count <= len(corners) else f"claims {count} corners and has {len(words) - 1}"
        raise MeshError(f"face {i} {had}; the file is damaged, export it again")
    return corners + [int(word) for word in words[4 : count + 1]]


def _stl(raw: bytes) -> tuple[Any, Any]:
    faces = int.from_bytes(raw[80:84], "little")
    if len(raw) == 84 + 50 * faces:
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        V = np.frombuffer(raw, dtype=record, offset=84)["corners"].reshape(-1, 3)
    elif raw.lstrip()[:5].lower() == b"solid":
        V = np.array(re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", raw, re.IGNORECASE)).astype(np.float64).reshape(-1, 3)
        faces = len(re.findall(rb"endfacet", raw, re.IGNORECASE))
        if len(V) != 3 * faces or raw.lower().rfind(b"endsolid") < raw.lower().rfind(b"facet"):
            raise MeshError(f"{len(V)} corners in {faces} finished facets and no endsolid after them; the file is cut short")
    else:
        raise MeshError(f"claims {faces} facets in {len(raw)} bytes; the file is damaged or cut short")
    return V, np.arange(len(V)).reshape(-1, 3)


def _glb(raw: bytes) -> tuple[Any, Any]:
    if raw[:4] != b"glTF" or int.from_bytes(raw[8:12], "little") > len(raw):
        raise MeshError("no complete binary glTF; the file is damaged, cut short or something else")
    header = json.loads(raw[20 : 20 + int.from_bytes(raw[12:16], "little")])
    if outside := [b["uri"] for b in header.get("buffers", []) if not str(b.get("uri", "data:")).startswith("data:")]:
        raise MeshError(f"keeps its data outside itself, in {outside[0]!r}, which is not opened; export it as one file")
    encoded = _ENCODED & set(header.get("extensionsRequired", []))
    if encoded or any("bufferView" not in a or "sparse" in a for a in header.get("accessors", [])):
        what = ", ".join(sorted(encoded)) or "sparse or compressed arrays"
        raise MeshError(f"uses {what}, which is not read; export it uncompressed")
    if why := bomb(len(raw), unfolded_bytes(Gltf(header, b""))):
        raise MeshError(f"its scene: {why}")
    from trimesh.exchange.gltf import load_glb

    scene = load_glb(BytesIO(raw), resolver=None, skip_materials=True)
    meshes = {key: mesh for key, mesh in scene["geometry"].items() if "faces" in mesh}
    world = {scene["base_frame"]: np.eye(4)}
    placed = [] if scene["graph"] else [(key, np.eye(4)) for key in meshes]
    for edge in scene["graph"]:  # parents come before their children
        world[edge["frame_to"]] = world[edge["frame_from"]] @ edge["matrix"]
        if edge.get("geometry") in meshes:
            placed.append((edge["geometry"], world[edge["frame_to"]]))
    vertices, faces = (sum(len(meshes[key][part]) for key, _ in placed) for part in ("vertices", "faces"))
    if vertices > _MOST_VERTICES or faces > _MOST_FACES:
        raise MeshError(
            f"its scene unfolds to {vertices} vertices and {faces} faces, more than {_MOST_VERTICES} and {_MOST_FACES};"
            " no frame needs as many"
        )
    V, F, begin = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)], 0
    for key, M in placed:
        X, G = checked(meshes[key]["vertices"], meshes[key]["faces"], f"mesh {key}")
        V.append(X @ M[:3, :3].T + M[:3, 3])
        # a mirror turns faces inside out unless their corners are turned too
        F.append((G[:, ::-1] if np.linalg.det(M[:3, :3]) < 0 else G).astype(np.int64) + begin)
        begin += len(X)
    return np.concatenate(V), np.concatenate(F)


_READERS: dict[str, Callable[[bytes], tuple[Any, Any]]] = {
    ".ply": _ply,
    ".obj": _obj,
    ".off": _off,
    ".stl": _stl,
    ".glb": _glb,
    ".drc": draco.unpacked,
}
