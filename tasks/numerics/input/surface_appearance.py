"""Texture coordinates, colours and textures of one frame, as its file has them, for the corners of its faces.

Geometry is read by `formats`, `animated` and `zipped`, which know nothing of appearance; what is read here is held against it.
Sources: Wavefront OBJ and MTL (Bourke's notes); Turk 1994 for PLY with the properties of MeshLab; glTF 2.0, Sec. 3.7.2 and 3.9.
"""

import re
from array import array
from collections.abc import Callable
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
from trimesh.exchange.ply import load_ply
from trimesh.geometry import triangulate_quads

from kinetree.errors import MeshError
from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.gltf_appearance import Material, SurfaceAppearance, glb_appearance
from kinetree.tasks.numerics.input.pictures import MOST_BYTES, Picture, picture
from kinetree.tasks.numerics.input.polygons import triangles_of
from kinetree.tasks.numerics.input.text_lines import text_lines

Beside = Callable[[str], bytes | None]
"""Bytes of a file that lies beside the mesh, by its name; None where it is not there or may not be opened."""
MOST_MATERIALS = 1024
"""Of one frame; captures have a few."""
MOST_PICTURE_BYTES = 4 * MOST_BYTES
"""Of all pictures of one frame."""


def surface_appearance(raw: bytes, suffix: str, faces: Faces, beside: Beside, moves: bool = False) -> SurfaceAppearance | None:
    """The appearance of a mesh from the bytes of its file; None where it has none or nothing of it is known.

    suffix : of the format
    faces  : (face, corner) as geometry is read, which the file must agree with
    beside : what opens files that the mesh names
    moves  : whether it was read as one file that holds all frames
    raises : MeshError where it has an appearance that does not fit its faces, or colours that are NaN or infinite
    """
    read: dict[str, Callable[[bytes, Beside], SurfaceAppearance | None]]
    read = {".obj": _obj, ".ply": _ply, ".drc": _draco, ".glb": lambda raw, _: glb_appearance(raw, faces, moves)}
    if suffix.lower() not in read:
        return None
    appearance = read[suffix.lower()](raw, beside)
    if appearance is not None and (appearance.faces.shape != faces.shape or (appearance.faces != faces).any()):
        raise MeshError("its texture coordinates and colours are of other faces than its surface")
    if appearance is not None and not _has_finite_colours(appearance):
        raise MeshError("its colours are not all finite; export it again")
    return appearance


def _has_finite_colours(appearance: SurfaceAppearance) -> bool:
    of_materials = np.array([material.colour for material in appearance.materials])
    return bool(np.isfinite(of_materials).all() and (appearance.colour is None or np.isfinite(appearance.colour).all()))


def names_appearance(raw: bytes, suffix: str) -> bool:
    """Whether a file promises colours or textures, seen without reading its rows; True where that cannot be seen.

    suffix : of the format
    """
    if suffix.lower() == ".ply":
        header = raw[:_MOST_HEADER].partition(b"end_header")[0].lower()
        return b" red" in header or b"texturefile" in header
    if suffix.lower() == ".obj":
        first = re.search(rb"^v[ \t]+(.*)$", raw, re.MULTILINE)
        return b"mtllib" in raw or (first is not None and len(first.group(1).split()) == 6)
    if suffix.lower() == ".glb":
        return b"COLOR_0" in raw or b"TEXCOORD_0" in raw
    return suffix.lower() == ".drc"


_MOST_HEADER = 65536
"""Bytes of a PLY in which its header ends."""
_MOST_TEXT_BYTES = 2**26
"""Of a PLY's text whose colours are read, which takes up to 75 times as many of memory."""


class _Corners(NamedTuple):
    """Polygons one after the other: vertex and texture coordinate (−1: none) of each corner, corners and material of each."""

    vertex: "array[int]"
    coordinate: "array[int]"
    counts: "array[int]"
    material: "array[int]"


def _obj(raw: bytes, beside: Beside) -> SurfaceAppearance | None:
    colours, uv = array("d"), array("d")
    libraries: list[str] = []
    used = {"": 0}
    corners, current, vertices = _Corners(array("q"), array("q"), array("q"), array("q")), 0, 0
    for line in text_lines(raw, are_continued=True):
        key, _, rest = line.strip().partition(b" ")
        if key == b"v":
            vertices += 1
            words = rest.split(None, 7)
            colours.extend(map(float, words[3:6] if len(words) == 6 else ()))
        elif key == b"vt":
            uv.extend(map(float, (*rest.split(None, 2), b"0")[:2]))
        elif key == b"mtllib":
            libraries.append(rest.strip().decode("utf-8", "replace"))
        elif key == b"usemtl":
            current = used.setdefault(rest.strip().decode("utf-8", "replace"), len(used))
            if len(used) > MOST_MATERIALS:
                raise MeshError(f"it uses more than {MOST_MATERIALS} materials")
        elif key == b"f":
            _add_polygon(corners, rest.split(), vertices, len(uv) // 2, current)
    F, polygon = triangles_of(corners.vertex, corners.counts)
    materials, pictures, missing = _materials(list(used), libraries, beside)
    colour = _linear(np.reshape(colours, (-1, 3))) if len(colours) == 3 * vertices > 0 else None
    if not uv and colour is None and len(used) == 1:
        return None
    return SurfaceAppearance(
        faces=F,
        uv=_flipped(uv)[triangles_of(corners.coordinate, corners.counts)[0]] if uv else None,
        colour=None if colour is None else colour[F],
        material=np.asarray(corners.material)[polygon],
        materials=materials,
        pictures=pictures,
        missing=missing,
    )


def _flipped(uv: "array[float]") -> Floats:
    """(coordinate, 2) from the upper left, as glTF has them; a last one for corners without any."""
    return np.append(uv, (0.0, 0.0)).reshape(-1, 2) * (1.0, -1.0) + (0.0, 1.0)


def _add_polygon(corners: _Corners, words: list[bytes], vertices: int, coordinates: int, material: int) -> None:
    """One face of an OBJ; negative indices count back from what was read so far."""
    for word in words:
        v, _, rest = word.partition(b"/")
        t = rest.partition(b"/")[0]
        corners.vertex.append(int(v) + vertices if int(v) < 0 else int(v) - 1)
        at = -1 if not t else int(t) + coordinates if int(t) < 0 else int(t) - 1
        corners.coordinate.append(at if 0 <= at < coordinates else -1)
    corners.counts.append(len(words))
    corners.material.append(material)


def _materials(
    used: list[str], libraries: list[str], beside: Beside
) -> tuple[tuple[Material, ...], tuple[Picture, ...], tuple[str, ...]]:
    """The materials of an OBJ by name, from the files that it names; the first is that of faces without one."""
    properties: dict[str, dict[str, str]] = {}
    missing: list[str] = []
    for name in libraries:
        text = beside(name)
        missing += [f"{name} is not there"] if text is None else []
        current: dict[str, str] = {}
        for line in (text or b"").decode("utf-8", "replace").splitlines():
            key, _, rest = line.strip().partition(" ")
            if key == "newmtl":
                current = properties.setdefault(rest.strip(), {})
            else:
                current[key.lower()] = rest.strip()
    pictures: list[Picture] = []
    index_of: dict[str, int | None] = {}
    materials = []
    for name in used:
        own = properties.get(name, {})
        file = own.get("map_kd", "")
        if file and file not in index_of:
            index_of[file] = _entered(file, beside, pictures, missing)
        picture_index = index_of.get(file)
        rgb = [float(w) for w in own.get("kd", "").split()[:3]]
        colour = (*rgb, 1.0) if len(rgb) == 3 and picture_index is None else (1.0, 1.0, 1.0, 1.0)
        materials.append(Material(name or "body", tuple(float(np.clip(c, 0, 1)) for c in colour), picture_index))
    return tuple(materials), tuple(pictures), tuple(missing)


def _entered(file: str, beside: Beside, pictures: list[Picture], missing: list[str]) -> int | None:
    """Adds a picture and returns its place; None where it cannot be had, which `missing` says."""
    name, raw = file, beside(file)
    if raw is None and file.split()[-1] != file:  # options may stand before the name
        name = file.split()[-1]
        raw = beside(name)
    texture = picture(raw) if raw is not None else f"{name} is not there"
    if not isinstance(texture, str) and sum(len(p.raw) for p in pictures) + len(texture.raw) > MOST_PICTURE_BYTES:
        texture = f"with it all pictures have more than {MOST_PICTURE_BYTES} bytes"
    if isinstance(texture, str):
        missing.append(texture if raw is None else f"{name}: {texture}")
        return None
    pictures.append(texture)
    return len(pictures) - 1


def _ply(raw: bytes, beside: Beside) -> SurfaceAppearance | None:
    header = raw.partition(b"end_header")[0].decode("ascii", "replace")
    if "format ascii" in header and len(raw) > _MOST_TEXT_BYTES:
        raise MeshError(f"{len(raw)} bytes of text, more than {_MOST_TEXT_BYTES}; save it as binary")
    mesh = load_ply(BytesIO(raw), skip_materials=True, fix_texture=False)
    rows, polygons = (mesh["metadata"]["_ply_raw"][k]["data"] for k in ("vertex", "face"))
    F = np.asarray(triangulate_quads(mesh["faces"]), dtype=np.int64).reshape(-1, 3)
    colour = _columns(rows, ("red", "green", "blue"))
    uv = next((c for names in _PLY_UV if (c := _columns(rows, names)) is not None), None)
    corner_uv = _column(polygons, "texcoord")
    if corner_uv is not None and corner_uv.shape == (len(F), 6):
        at_corners: Floats | None = corner_uv.reshape(-1, 3, 2)
    else:
        at_corners = None if uv is None else uv[F]
    if colour is None and at_corners is None:
        return None
    pictures: list[Picture] = []
    missing: list[str] = []
    names = [line.split(None, 2)[2].strip() for line in header.splitlines() if line.lower().startswith("comment texturefile ")]
    picture_index = _entered(names[0], beside, pictures, missing) if names and at_corners is not None else None
    return SurfaceAppearance(
        faces=F,
        uv=None if at_corners is None else at_corners * (1.0, -1.0) + (0.0, 1.0),
        colour=None if colour is None else _linear(colour / 255.0)[F],
        material=np.zeros(len(F), np.int64),
        materials=(Material("body", (1.0, 1.0, 1.0, 1.0), picture_index),),
        pictures=tuple(pictures),
        missing=tuple(missing),
    )


_PLY_UV = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))


def _columns(rows: Any, names: tuple[str, ...]) -> Floats | None:
    """(row, name) some properties of a PLY's element; None where one is lacking."""
    columns = [_column(rows, name) for name in names]
    present = [np.ravel(c) for c in columns if c is not None and c.size]
    return np.column_stack(present) if len(present) == len(names) else None


def _column(rows: Any, name: str) -> Floats | None:
    """One property, a list's as (row, item)."""
    columns = rows if isinstance(rows, dict) else {key: rows[key] for key in rows.dtype.names or ()}
    if name not in columns:
        return None
    values = columns[name]
    if getattr(values, "dtype", None) is not None and values.dtype.names:
        values = values["f1"]
    return np.asarray(values, dtype=np.float64)


def _draco(raw: bytes, _: Beside) -> SurfaceAppearance | None:
    from importlib import import_module

    mesh = import_module("DracoPy").decode(raw)
    F = np.asarray(mesh.faces, dtype=np.int64)
    colour, uv = getattr(mesh, "colors", None), getattr(mesh, "tex_coord", None)
    if colour is None and uv is None:
        return None
    return SurfaceAppearance(
        faces=F,
        uv=None if uv is None else (np.asarray(uv, np.float64) * (1.0, -1.0) + (0.0, 1.0))[F],
        colour=None if colour is None else _linear(np.asarray(colour, np.float64)[:, :3] / 255.0)[F],
        material=np.zeros(len(F), np.int64),
        materials=(Material("body", (1.0, 1.0, 1.0, 1.0), None),),
        pictures=(),
        missing=(),
    )


def _linear(srgb: Floats) -> Floats:
    """Linear light of sRGB colours from 0 to 1 (IEC 61966-2-1)."""
    c = np.clip(srgb, 0.0, 1.0)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
