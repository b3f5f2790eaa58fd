"""Nasty meshes and sequences: how each is made, and what becomes of it. `test_nasty.py` runs them all.

A sequence has five frames of an ellipsoid that walks. A case is a function that is given a folder, puts the sequence there and
returns the input that a user would name. Frame 2 is the one that is spoilt where one frame is. Outcomes are:

    OK       done, no frame left out, and nothing remarked
    REMARK   done, no frame left out, with these words among the remarks
    DROPPED  done without frame 2, with these words as the reason
    REFUSED  ended as the user's error, with these words
"""

import gzip
import os
import struct
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import trimesh
from numerics.input.animated_glbs import TENTHS, GlbDraft

OK, REMARK, DROPPED, REFUSED = "ok", "remark", "dropped", "refused"
BALL = trimesh.creation.icosphere(subdivisions=2)
V, F = np.array(BALL.vertices) * [1.0, 2.0, 0.7], np.array(BALL.faces, dtype=np.int64)
FRAMES, SPOILT = 5, 2


class Case(NamedTuple):
    """A nasty sequence."""

    write: Callable[[Path], Path | str]
    """Writes it below a folder, and says what to name as the input."""
    outcome: str
    words: str = ""
    """Of the remark, the reason or the refusal."""
    counts: Mapping[str, int] = MappingProxyType({})
    """What cleaning frame 2 counted, where it is not dropped; `vertices` and `faces` are what it left."""
    numbers: tuple[int, ...] = tuple(range(FRAMES))
    """Of the frames that there are."""


def vertices(t: int) -> np.ndarray[Any, Any]:
    """Of frame t, in the same order in every frame."""
    return V + [0.1 * t, 0.0, 0.0]


def surface(t: int) -> tuple[Any, Any]:
    """Of frame t, in an order of its own."""
    order = np.random.default_rng(t).permutation(len(V))
    return vertices(t)[order], np.argsort(order)[F]


def off(V: Any, F: Any) -> bytes:
    """An OFF file."""
    rows = [" ".join(map(str, v)) for v in V] + [f"{len(f)} " + " ".join(map(str, f)) for f in F]
    return "\n".join(["OFF", f"{len(V)} {len(F)} 0", *rows, ""]).encode()


def obj(V: Any, F: Any) -> bytes:
    """An OBJ file."""
    return (
        "".join(f"v {x} {y} {z}\n" for x, y, z in V) + "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in F)
    ).encode()


def ply(V: Any, F: Any, *, vertex_count: Any = None, face_count: Any = None, end: str = "<") -> bytes:
    """A binary PLY file, whose header may lie."""
    kind = {"<": "little", ">": "big"}[end]
    head = f"ply\nformat binary_{kind}_endian 1.0\nelement vertex {len(V) if vertex_count is None else vertex_count}\n"
    head += "property float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(F) if face_count is None else face_count}\nproperty list uchar int vertex_indices\nend_header\n"
    return (
        head.encode() + np.asarray(V, f"{end}f4").tobytes() + b"".join(struct.pack(f"{end}B{len(f)}i", len(f), *f) for f in F)
    )


def stl(V: Any, F: Any, claimed: int | None = None) -> bytes:
    """A binary STL file, whose header may lie."""
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *np.asarray(V)[f].ravel(), 0) for f in F)
    return bytes(80) + struct.pack("<I", len(F) if claimed is None else claimed) + rows


def glb(V: Any, F: Any) -> bytes:
    """A GLB file."""
    written: bytes = trimesh.Scene(trimesh.Trimesh(V, F, process=False)).export(file_type="glb")
    return written


WRITERS: dict[str, Callable[[Any, Any], bytes]] = {"off": off, "obj": obj, "ply": ply, "stl": stl, "glb": glb}


def whole(folder: Path, suffix: str = "off", names: str = "frame_{}") -> Path:
    """Five frames that are in order."""
    folder = folder / "scans"
    folder.mkdir()
    for t in range(FRAMES):
        (folder / f"{names.format(t)}.{suffix}").write_bytes(WRITERS[suffix](*surface(t)))
    return folder


def one(content: bytes | str | Callable[[], bytes], suffix: str = "off") -> Callable[[Path], Path]:
    """Frame 2 holds this instead."""

    def write(folder: Path) -> Path:
        raw = content() if callable(content) else content
        scans = whole(folder, suffix)
        (scans / f"frame_{SPOILT}.{suffix}").write_bytes(raw.encode() if isinstance(raw, str) else raw)
        return scans

    return write


def mesh(change: Callable[[Any, Any], tuple[Any, Any]], suffix: str = "off") -> Callable[[Path], Path]:
    """Frame 2 holds the changed mesh."""
    return one(lambda: WRITERS[suffix](*change(*surface(SPOILT))), suffix)


def all_of(change: Callable[[Any, Any], tuple[Any, Any]], suffix: str = "off") -> Callable[[Path], Path]:
    """Every frame is changed."""

    def write(folder: Path) -> Path:
        scans = whole(folder, suffix)
        for t in range(FRAMES):
            (scans / f"frame_{t}.{suffix}").write_bytes(WRITERS[suffix](*change(*surface(t))))
        return scans

    return write


def named(*names: str) -> Callable[[Path], Path]:
    """Frames under these names, in this order."""

    def write(folder: Path) -> Path:
        (folder / "scans").mkdir()
        for t, name in enumerate(names):
            (folder / "scans" / name).write_bytes(WRITERS[name.lower().rpartition(".")[2]](*surface(t)))
        return folder / "scans"

    return write


def beside(name: str, put: Callable[[Path], None], remove: str = "") -> Callable[[Path], Path]:
    """Something else lies in the folder."""

    def write(folder: Path) -> Path:
        scans = whole(folder)
        if remove:
            (scans / remove).unlink()
        put(scans / name)
        return scans

    return write


def text(change: Callable[[str], str], suffix: str = "off") -> Callable[[Path], Path]:
    """The text of frame 2 is written otherwise."""
    return one(lambda: change(WRITERS[suffix](*surface(SPOILT)).decode()).encode(), suffix)


def packed(**changes: Any) -> Callable[[Path], Path]:
    """All frames in one npz."""

    def write(folder: Path) -> Path:
        arrays = {
            "vertices": np.concatenate([vertices(t) for t in range(FRAMES)]).astype("f4"), "faces": F.astype("i4"),
            "vertex_offsets": np.arange(FRAMES + 1) * len(V), "face_offsets": np.array([0, len(F)]), "fps": 25.0, "unit": "mm",
        }  # fmt: skip
        np.savez(folder / "walk.npz", **{k: v for k, v in {**arrays, **changes}.items() if v is not None})
        return folder / "walk.npz"

    return write


def zipped(members: Callable[[], dict[str, bytes]]) -> Callable[[Path], Path]:
    """A zip of these members."""

    def write(folder: Path) -> Path:
        with zipfile.ZipFile(folder / "walk.zip", "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in members().items():
                archive.writestr(name, content)
        return folder / "walk.zip"

    return write


def frames_of_zip(pattern: str = "walk/frame_{}.off") -> dict[str, bytes]:
    """Members that are frames."""
    return {pattern.format(t): off(*surface(t)) for t in range(FRAMES)}


def in_file(name: str, content: Callable[[], bytes]) -> Callable[[Path], Path]:
    """One file."""

    def write(folder: Path) -> Path:
        (folder / name).write_bytes(content())
        return folder / name

    return write


def moving(change: Callable[[GlbDraft], object]) -> bytes:
    """An animated GLB, spoilt."""
    draft = GlbDraft().moves("translation", TENTHS, np.outer(TENTHS, [1, 2, 3]))
    change(draft)
    return draft.raw()


# ── shapes ──────────────────────────────────────────────────────────────────────────────────────────────────────────


def joined(*parts: tuple[Any, Any]) -> tuple[Any, Any]:
    """Several meshes as one."""
    shift = np.cumsum([0, *(len(V) for V, _ in parts)])
    return np.concatenate([V for V, _ in parts]), np.concatenate([F + n for n, (_, F) in zip(shift, parts, strict=False)])


def soup(V: Any, F: Any) -> tuple[Any, Any]:
    """Three vertices a face."""
    return V[F].reshape(-1, 3), np.arange(3 * len(F)).reshape(-1, 3)


def placed(shape: trimesh.Trimesh, at: Any = (0, 0, 0)) -> tuple[Any, Any]:
    """A mesh somewhere else."""
    return np.array(shape.vertices) + at, np.array(shape.faces)


def flipped(F: Any, share: float = 1.0) -> Any:
    """Some faces inside out."""
    return np.where((np.arange(len(F)) < share * len(F))[:, None], F[:, ::-1], F)


def holed(V: Any, F: Any) -> tuple[Any, Any]:
    """Without a cap."""
    return V, F[V[F].mean(axis=1)[:, 1] < 1.5]


def torn(V: Any, F: Any) -> tuple[Any, Any]:
    """In nine pieces as large as each other."""
    return joined(*[placed(trimesh.creation.box((0.7, 0.7, 0.3)), (0, 0.45 * i - 1.8, 0)) for i in range(9)])


def fin(V: Any, F: Any) -> tuple[Any, Any]:
    """An edge that three faces share."""
    return np.concatenate([V, [V[F[0, 0]] * 1.2]]), np.concatenate([F, [[F[0, 0], F[0, 1], len(V)]]])


def ring(V: Any, F: Any) -> tuple[Any, Any]:
    """A body with a loop."""
    return placed(trimesh.creation.torus(1.3, 0.4, major_sections=24, minor_sections=10), V.mean(axis=0))


def strip(V: Any, F: Any) -> tuple[Any, Any]:
    """A Möbius strip, which has one side."""
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    points = [
        [(1.5 + w * np.cos(a / 2)) * np.cos(a), (1.5 + w * np.cos(a / 2)) * np.sin(a), w * np.sin(a / 2)]
        for a in angle for w in (-0.6, 0.6)
    ]  # fmt: skip
    after = [[2 * i + 2, 2 * i + 3] if i < 39 else [1, 0] for i in range(40)]
    return np.array(points), np.array([f for i, (a, b) in enumerate(after) for f in ([2 * i, 2 * i + 1, a], [2 * i + 1, b, a])])


def polygons(V: Any, F: Any) -> tuple[Any, Any]:
    """Half of the faces as quads, with a point on an edge that the neighbour does not know."""
    middle, many, extra = (V[F[:, 0]] + V[F[:, 1]]) / 2, [], []
    for i, (a, b, c) in enumerate(F.tolist()):
        many.append([a, len(V) + i, b, c] if i % 2 else [a, b, c])
        extra.append(middle[i])
    return np.concatenate([V, extra]), many


# ── all of them ─────────────────────────────────────────────────────────────────────────────────────────────────────

BALLS = placed(trimesh.creation.icosphere(subdivisions=1, radius=0.05), (3.0, 0.0, 0.0))
TEN = tuple(range(11))
UNIT = "in another unit?"
TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])

CASES: dict[str, Case] = {
    # files that are no mesh
    "empty file": Case(one(b""), DROPPED, "the file is empty"),
    "another format": Case(one("hello"), DROPPED, "does not begin with OFF"),
    "binary noise": Case(one(bytes(range(256)) * 9), DROPPED, "does not begin with OFF"),
    "cut short": Case(one(lambda: off(V, F)[:900]), DROPPED, "the file is cut short"),
    "PLY cut short": Case(one(lambda: ply(V, F)[:-200], "ply"), DROPPED, "PLY is unexpected length!"),
    "PLY of text cut in the header": Case(one(b"ply\nformat ascii 1.0\nelement vertex 9", "ply"), DROPPED, "no PLY header"),
    "STL cut short": Case(one(lambda: stl(V, F)[:-70], "stl"), DROPPED, "claims 320 facets in 16014 bytes"),
    "GLB cut short": Case(one(lambda: glb(V, F)[:-70], "glb"), DROPPED, "no complete binary glTF"),
    "OBJ without faces": Case(one("v 0 0 0\nv 1 0 0\n", "obj"), DROPPED, "no faces, only 2 vertices"),
    "JPEG named OBJ": Case(one(bytes.fromhex("ffd8ffe000104a464946") * 50, "obj"), DROPPED, "no vertices"),
    "page of a server named PLY": Case(one("<!DOCTYPE html><h1>404</h1>", "ply"), DROPPED, "no PLY header"),
    "pointer of Git LFS": Case(
        one("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", "ply"), DROPPED, "no PLY header"
    ),
    "null bytes": Case(one(bytes(4000), "stl"), DROPPED, "claims 0 facets in 4000 bytes"),
    # files that lie
    "claims a billion": Case(one("OFF\n1000000000 1000000000 0\n0 0 0\n"), DROPPED, "the file is cut short"),
    "claims less than none": Case(one("OFF\n-4 4 0\n0 0 0\n"), DROPPED, "the file is cut short"),
    "corner count of a billion": Case(
        text(lambda s: s.replace("\n3 ", "\n1000000000 ", 1)), DROPPED, "face 0 claims 1000000000 corners and has 3"
    ),
    "PLY claims 2^64 vertices": Case(one(lambda: ply(V, F, vertex_count=2**64), "ply"), DROPPED, "its header claims"),
    "PLY promises fewer faces": Case(one(lambda: ply(V, F, face_count=9), "ply"), DROPPED, "PLY is unexpected length!"),
    "PLY promises more faces": Case(one(lambda: ply(V, F, face_count=999), "ply"), DROPPED, "PLY is unexpected length!"),
    "STL promises 2^32 - 1 faces": Case(one(lambda: stl(V, F, 2**32 - 1), "stl"), DROPPED, "claims 4294967295 facets in"),
    "STL promises fewer faces": Case(one(lambda: stl(V, F, 7), "stl"), DROPPED, "claims 7 facets in"),
    # numbers
    "indices from 1": Case(mesh(lambda V, F: (V, F + 1)), DROPPED, "its indices start at 1"),
    "negative index": Case(mesh(lambda V, F: (V, np.concatenate([F, [[0, 1, -3]]]))), DROPPED, "is -3, but the mesh has 162"),
    "index out of range": Case(
        mesh(lambda V, F: (V, np.concatenate([F, [[0, 1, 9000]]]))), DROPPED, "is 9000, but the mesh has"
    ),
    "huge index": Case(one(lambda: off(V, [*F.tolist(), [0, 1, 2**70]])), DROPPED, "the file is damaged"),
    "NaN": Case(mesh(lambda V, F: (np.concatenate([V[1:], [[0, 0, np.nan]]]), F)), DROPPED, "1 of 162 vertices are NaN"),
    "infinity": Case(
        mesh(lambda V, F: (np.concatenate([V[1:], [[0, 0, np.inf]]]), F)), DROPPED, "1 of 162 vertices are NaN or inf"
    ),
    "all NaN in STL": Case(mesh(lambda V, F: (V * np.nan, F), "stl"), DROPPED, "960 of 960 vertices are NaN"),
    "comma as decimal point": Case(text(lambda s: s.replace(".", ",")), DROPPED, "could not convert string to float: '"),
    "exponents of Fortran": Case(
        text(lambda s: s.replace("e-", "D-").replace("0.", "0.0D0", 1)), DROPPED, "could not convert string to float: '"
    ),
    "coordinate of 400 digits": Case(
        one(lambda: off([["9" * 400, 0, 0], *V[1:]], F)), DROPPED, "1 of 162 vertices are NaN or inf"
    ),
    "coordinates of 1e300": Case(
        mesh(lambda V, F: (V * 1e300, F)), DROPPED, "its coordinates are so large that no number holds its area"
    ),
    # sizes and places
    "no faces": Case(mesh(lambda V, F: (V, F[:0])), DROPPED, "a surface is needed, not a point cloud"),
    "no vertices": Case(one("OFF\n0 0 0\n"), DROPPED, "no vertices"),
    "one triangle": Case(mesh(lambda V, F: (V, F[:1])), DROPPED, "its size is"),
    "all in one point": Case(mesh(lambda V, F: (V * 0, F)), DROPPED, "its faces have no area"),
    "flat line": Case(mesh(lambda V, F: (V * [1, 0, 0], F)), DROPPED, "faces have no area"),
    "a thousand times larger": Case(mesh(lambda V, F: (V * 1000, F)), DROPPED, UNIT),
    "metres among millimetres": Case(mesh(lambda V, F: (V / 1000, F)), DROPPED, UNIT),
    "inches among centimetres": Case(mesh(lambda V, F: (V / 2.54, F)), DROPPED, "its area is 2.733"),
    "far away": Case(mesh(lambda V, F: (V + 500, F)), DROPPED, "away from the frames around it"),
    "torn into nine pieces": Case(mesh(torn), DROPPED, "torn into 9 large pieces"),
    "another shape": Case(mesh(lambda V, F: placed(trimesh.creation.icosphere(radius=6), V.mean(axis=0))), DROPPED, UNIT),
    "half of the frames in metres": Case(lambda folder: _half(folder), REFUSED, "frames cannot be used"),
    "all frames damaged": Case(lambda folder: _all(folder, b"hello"), REFUSED, "5 of 5 frames cannot be used"),
    "all frames as large as atoms": Case(all_of(lambda V, F: (V * 1e-10, F)), OK),
    "all frames as large as planets": Case(all_of(lambda V, F: (V * 1e10, F)), OK),
    "far from the origin": Case(all_of(lambda V, F: (V + 1e6, F)), OK),
    "so far that digits are lost": Case(all_of(lambda V, F: (V + 1e9, F), "stl"), REFUSED, "its faces have no area"),
    "nothing moves": Case(all_of(lambda W, F: (V, F)), OK),
    # surfaces
    "inside out": Case(mesh(lambda V, F: (V, F[:, ::-1])), OK, counts={"flipped": 320}),
    "half inside out": Case(mesh(lambda V, F: (V, flipped(F, 0.4))), OK, counts={"flipped": 128}),
    "soup of triangles": Case(mesh(soup, "stl"), OK, counts={"merged": 798, "vertices": 162}),
    "every face twice": Case(mesh(lambda V, F: (V, np.concatenate([F, F]))), OK, counts={"duplicate": 320, "faces": 320}),
    "drawn from both sides": Case(mesh(lambda V, F: (V, np.concatenate([F, F[:, ::-1]]))), OK, counts={"duplicate": 320}),
    "every vertex twice": Case(
        mesh(lambda V, F: (np.concatenate([V, V]), np.where(np.arange(len(F))[:, None] % 2, F, F + len(V)))),
        OK,
        counts={"merged": 162, "vertices": 162},
    ),
    "stray vertices": Case(
        mesh(lambda V, F: (np.concatenate([V, [[1e12, 0, 0], [1e300, 0, 0]]]), F)), OK, counts={"unreferenced": 2}
    ),
    "faces that are points": Case(mesh(lambda V, F: (V, np.concatenate([F, F[:9, [0, 0, 0]]]))), OK, counts={"degenerate": 9}),
    "quads and triangles": Case(all_of(polygons), OK, counts={"needles": 160}),
    "cap cut off": Case(mesh(holed), OK, counts={"boundary_edges": 18, "vertices": 149}),
    "fin on an edge": Case(mesh(fin), OK, counts={"non_manifold_edges": 1}),
    "ring": Case(all_of(ring), OK, counts={"euler": 0}),
    "strip of Möbius": Case(all_of(strip), OK, counts={"disagreeing_edges": 1}),
    "debris": Case(mesh(lambda V, F: joined((V, F), BALLS)), OK, counts={"components": 2, "components_kept": 1}),
    "shell inside": Case(
        mesh(lambda V, F: joined((V, F), (V.mean(axis=0) + 0.5 * (V - V.mean(axis=0)), F))),
        OK,
        counts={"nested": 1, "faces": 320},
    ),
    "two bodies": Case(all_of(lambda V, F: joined((V, F), (V + [5, 0, 0], F))), OK, counts={"components_kept": 2}),
    "two bodies in one frame": Case(
        mesh(lambda V, F: joined((V, F), (V + [3, 0, 0], F))),
        DROPPED,
        "another body is in it: it has 2 large pieces and 2 times the area, most frames have 1",
    ),
    "a tetrahedron": Case(all_of(lambda V, F: (TETRAHEDRON[0] + V.mean(axis=0), TETRAHEDRON[1])), OK),
    "crossing itself": Case(
        all_of(lambda V, F: (np.stack([V[:, 0], np.abs(V[:, 1]), V[:, 2]], axis=1) + 0.3 * np.sin(9 * V[:, [1]]), F)), OK
    ),
    # text
    "line ends of Windows": Case(text(lambda s: s.replace("\n", "\r\n")), OK),
    "line ends of old Macintosh": Case(text(lambda s: s.replace("\n", "\r")), OK),
    "byte order mark": Case(text(lambda s: "\ufeff" + s), OK),
    "byte order mark in OBJ": Case(text(lambda s: "\ufeff" + s, "obj"), OK),
    "UTF-16": Case(one(lambda: off(V, F).decode().encode("utf-16")), DROPPED, "does not begin with OFF"),
    "tabs, comments, blank lines": Case(text(lambda s: s.replace(" ", "\t").replace("\n", " # note\n\n", 40)), OK),
    "line of a megabyte": Case(text(lambda s: s.replace("OFF\n", "OFF\n#" + "x" * 2**20 + "\n")), OK),
    "null in the text": Case(text(lambda s: s.replace("\n3 ", "\n\0 3 ", 1)), DROPPED, "invalid literal for int()"),
    "OBJ with negative indices": Case(
        text(
            lambda s: "".join(
                " ".join(["f", *(str(int(i) - 163) for i in line.split()[1:])]) + "\n" if line[0] == "f" else line
                for line in s.splitlines(True)
            ),
            "obj",
        ),
        OK,
    ),
    "OBJ with lines continued": Case(text(lambda s: s.replace("f ", "f \\\n"), "obj"), OK),
    # folders and names
    "numbers with gaps": Case(
        named("f_1.off", "f_2.off", "f_9.off", "f_10.off"), REMARK, "6 frames are missing: 3 to 8;", numbers=(1, 2, 9, 10)
    ),
    "numbers of different width": Case(named("f_8.off", "f_9.off", "f_10.off"), OK, numbers=(8, 9, 10)),
    "one number twice": Case(named("f_1.off", "f_01.off", "f_2.off"), REFUSED, "two files have the same number"),
    "two series": Case(
        named("a_1.off", "a_2.off", "b_1.off", "b_2.off"), REFUSED, "names of several series (2 × a_#, 2 × b_#)"
    ),
    "two formats": Case(
        named("1.off", "2.off", "3.obj"), REFUSED, "meshes of several formats (1 × .obj, 2 × .off); choose by a pattern such as"
    ),
    "one frame": Case(named("1.off"), REFUSED, "a single frame"),
    "endings in capitals": Case(named("1.OFF", "2.OFF", "3.OFF"), OK, numbers=(1, 2, 3)),
    "both kinds of capitals": Case(named("1.OFF", "2.off", "3.Off"), OK, numbers=(1, 2, 3)),
    "line end in a name": Case(named("a\nb_1.off", "a\nb_2.off"), OK, numbers=(1, 2)),
    "names that are options": Case(named("--help_1.off", "--help_2.off"), OK, numbers=(1, 2)),
    "names from right to left": Case(named("\u202effo_1.off", "\u202effo_2.off"), OK, numbers=(1, 2)),
    "names with wildcards": Case(named("[a]*_1.off", "[a]*_2.off"), OK, numbers=(1, 2)),
    "leavings of a file manager": Case(beside(".DS_Store", lambda p: p.write_bytes(b"x") and None), OK),
    "leavings of a Macintosh": Case(beside("._frame_2.off", lambda p: p.write_bytes(b"x") and None), OK),
    "notes in the folder": Case(beside("notes.txt", lambda p: p.write_text("hello") and None), OK),
    "folder named as a frame": Case(
        beside("frame_2.off", Path.mkdir, "frame_2.off"), REFUSED, "a folder under the name of a frame"
    ),
    "dangling link": Case(
        beside("frame_2.off", lambda p: p.symlink_to("nowhere"), "frame_2.off"),
        REFUSED,
        "a link to nowhere, which is not there",
    ),
    "link to itself": Case(
        beside("frame_2.off", lambda p: p.symlink_to("frame_2.off"), "frame_2.off"),
        REFUSED,
        "a link to frame_2.off, which is not there",
    ),
    "FIFO": Case(
        beside("frame_2.off", os.mkfifo, "frame_2.off"), REFUSED, "neither a file nor a folder (a pipe, socket or device)"
    ),
    "link to a device": Case(
        beside("frame_2.off", lambda p: p.symlink_to("/dev/zero"), "frame_2.off"),
        REFUSED,
        "neither a file nor a folder (a pipe",
    ),
    "link to a frame": Case(beside("frame_2.off", lambda p: p.symlink_to("frame_3.off"), "frame_2.off"), OK),
    "packed by gzip": Case(
        beside("frame_2.off.gz", lambda p: p.write_bytes(gzip.compress(b"x")) and None, "frame_2.off"),
        REFUSED,
        "frame_2.off.gz is packed",
    ),
    "all packed by gzip": Case(
        lambda folder: _gzipped(folder), REFUSED, "frame_0.off.gz (and 4 more) is packed; unpack it first"
    ),
    "foreign format": Case(
        in_file("walk.fbx", lambda: b"Kaydara FBX Binary"), REFUSED, "kinetree convert makes a sequence of it"
    ),
    "nothing there": Case(lambda folder: folder / "nowhere", REFUSED, "there is no such"),
    "empty name": Case(lambda folder: "", REFUSED, "no input"),
    "null in the path": Case(lambda folder: f"{folder}/a\0b", REFUSED, "it has a NUL byte"),
    "path of 5000 letters": Case(lambda folder: folder / ("x" * 5000), REFUSED, "File name too long; check its name"),
    # all frames in one file
    "npz without faces": Case(packed(faces=None), REFUSED, "no array faces"),
    "npz in a plane": Case(packed(vertices=np.zeros((810, 2))), REFUSED, "floating numbers (n, 3) are needed"),
    "npz of complex numbers": Case(packed(vertices=np.zeros((810, 3), "c8")), REFUSED, "vertices is complex64"),
    "npz with offsets that decrease": Case(packed(vertex_offsets=np.array([0, 324, 162])), REFUSED, "must increase"),
    "npz with offsets beyond": Case(
        packed(vertex_offsets=np.arange(6) * 10**15), REFUSED, "vertex_offsets run from 0 to 5000000000000000"
    ),
    "npz with a rate of NaN": Case(packed(fps=float("nan")), REFUSED, "one positive number of frames a second"),
    "npz of pickled objects": Case(packed(vertices=np.array([{}], dtype=object)), REFUSED, "Object arrays cannot be loaded"),
    "npz that is none": Case(in_file("walk.npz", lambda: b"PK\3\4"), REFUSED, "cannot be read as .npz"),
    "zip of frames": Case(zipped(frames_of_zip), OK),
    "zip with paths outside": Case(zipped(lambda: frames_of_zip("../../walk/frame_{}.off")), REFUSED, "leads out of the zip"),
    "zip with leavings of a Macintosh": Case(zipped(lambda: frames_of_zip() | {"__MACOSX/walk/._frame_0.off": b"x"}), OK),
    "zip in a zip": Case(zipped(lambda: {"walk.zip": b"PK\5\6" + bytes(18)}), REFUSED, "no mesh among its files"),
    "zip with a damaged frame": Case(
        zipped(lambda: frames_of_zip() | {"walk/frame_2.off": b"OFF\n9 9 9"}), DROPPED, "cut short"
    ),
    "animated GLB": Case(in_file("walk.glb", lambda: moving(lambda draft: None)), OK, numbers=TEN),
    "GLB without motion": Case(in_file("walk.glb", lambda: GlbDraft().raw()), REFUSED, "one mesh without animation"),
    "GLB with times that decrease": Case(
        in_file("walk.glb", lambda: GlbDraft().moves("translation", TENTHS[::-1], np.outer(TENTHS, [1, 2, 3])).raw()),
        REFUSED,
        "the keys of an animation do not fit its times",
    ),
    "GLB that lasts a century": Case(
        in_file("walk.glb", lambda: GlbDraft().moves("translation", TENTHS * 3e10, np.outer(TENTHS, [1, 2, 3])).raw()),
        OK,
        numbers=TEN,
    ),
    "GLB whose nodes are a ring": Case(
        in_file("walk.glb", lambda: moving(lambda draft: draft.document["nodes"][0].update(children=[0]))),
        REFUSED,
        "its nodes are no tree",
    ),
    "GLB that names a file outside": Case(
        in_file("walk.glb", lambda: moving(lambda draft: draft.document.update(images=[{"uri": "file:///etc/passwd"}]))),
        OK,
        numbers=TEN,
    ),
    "GLB with an accessor beyond its end": Case(
        in_file("walk.glb", lambda: moving(lambda draft: draft.document["accessors"][0].update(count=10**9))),
        REFUSED,
        "accessor 0 is of no known or of too large a layout",
    ),
    "GLB that wants an unknown extension": Case(
        in_file("walk.glb", lambda: moving(lambda draft: draft.document.update(extensionsRequired=["X_none"]))),
        REFUSED,
        "uses X_none, which is not read",
    ),
}


def _half(folder: Path) -> Path:
    scans = whole(folder)
    for t in (2, 3, 4):
        (scans / f"frame_{t}.off").write_bytes(off(vertices(t) * 1000, F))
    return scans


def _all(folder: Path, content: bytes) -> Path:
    scans = whole(folder)
    for t in range(FRAMES):
        (scans / f"frame_{t}.off").write_bytes(content)
    return scans


def _gzipped(folder: Path) -> Path:
    scans = whole(folder)
    for path in [*scans.iterdir()]:
        path.rename(path.with_suffix(".off.gz"))
    return scans
