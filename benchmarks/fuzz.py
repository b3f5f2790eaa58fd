"""Every parser of ours under coverage-guided fuzzing: whatever the bytes, a value or an InputError, in bounded time and memory.

    pip install atheris
    python benchmarks/fuzz.py [--parsers NAME ...] [--runs 1000000] [--seconds 0] [--work FOLDER]

--runs is the sum over all parsers. Each parser runs in a process of its own, instrumented by atheris (libFuzzer), beginning
with small valid files and what earlier calls found in FOLDER. An execution that raises anything but an InputError, takes more
than 10 s or more than 2 GB ends the parser's process; its input is kept as FOLDER/NAME.crash-…; `--replay FILE --parsers NAME`
tries it again without atheris. Columns: executions, how many a second, edges of the code reached, largest memory, failures.
"""

import argparse
import contextlib
import io
import json
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

SECONDS, MEGABYTES = 10, 2048
"""Of one execution."""
LONGEST = 4096
"""Bytes of an input."""
INSTRUMENTED = (
    "kinetree.errors",
    "kinetree.tasks.numerics.input",
    "kinetree.tasks.numerics.results",
    "trimesh.exchange",
    "yaml",
    "nrrd",
)

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


class Parser(NamedTuple):
    """How a file is read, the ending of its name, and small valid files."""

    read: Callable[[Path], Any]
    suffix: str
    seeds: Callable[[], list[bytes]]


# ── small valid files ───────────────────────────────────────────────────────────────────────────────────────────────


def _ply() -> list[bytes]:
    head = "ply\nformat {} 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    rows = "\n".join([" ".join(map(str, v)) for v in V] + ["3 " + " ".join(map(str, f)) for f in F]) + "\n"
    little = V.astype("<f4").tobytes() + b"".join(struct.pack("<B3i", 3, *map(int, f)) for f in F)
    big = V.astype(">f4").tobytes() + b"".join(struct.pack(">B3i", 3, *map(int, f)) for f in F)
    return [(head.format("ascii") + rows).encode(), head.format("binary_little_endian").encode() + little,
            head.format("binary_big_endian").encode() + big]  # fmt: skip


def _obj() -> list[bytes]:
    rows = [f"v {x} {y} {z}" for x, y, z in V] + ["vt 0 0", "vn 0 0 1"] + [f"f {a + 1}/1/1 {b + 1}//1 {c - 4}" for a, b, c in F]
    return [("\n".join(rows) + "\n").encode()]


def _off() -> list[bytes]:
    rows = [" ".join(map(str, v)) for v in V] + ["3 " + " ".join(map(str, f)) for f in F] + ["4 0 1 2 3 255 0 0 # a quad"]
    return [("OFF\n4 5 0\n" + "\n".join(rows) + "\n").encode()]


def _stl() -> list[bytes]:
    import trimesh

    body = trimesh.Trimesh(V, F, process=False)
    return [body.export(file_type="stl"), body.export(file_type="stl_ascii").encode()]


def _glb() -> list[bytes]:
    import trimesh

    scene = trimesh.Scene()
    scene.add_geometry(trimesh.Trimesh(V, F, process=False), transform=np.diag([-1.0, 1, 1, 1]))
    return [scene.export(file_type="glb")]


def _animated_glb() -> list[bytes]:
    """A tetrahedron with a skin, a morph target and three channels."""
    body = b""
    views: list[dict[str, int]] = []
    accessors: list[dict[str, Any]] = []

    def added(array: Any, kind: str, component: int) -> int:
        nonlocal body
        raw = array.tobytes()
        views.append({"buffer": 0, "byteOffset": len(body), "byteLength": len(raw)})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(array), "type": kind})
        body += raw + b"\0" * (-len(raw) % 4)
        return len(accessors) - 1

    X, times = added(V.astype("<f4"), "VEC3", 5126), added(np.array([0, 0.5, 1], "<f4"), "SCALAR", 5126)
    turns = added(np.eye(4, dtype="<f4")[[3, 0, 3]], "VEC4", 5126)
    joints, weights = added(np.zeros((4, 4), "u1"), "VEC4", 5121), added(np.eye(4, dtype="<f4")[[0] * 4], "VEC4", 5126)
    attributes = {"POSITION": X, "JOINTS_0": joints, "WEIGHTS_0": weights}
    primitive = {
        "attributes": attributes,
        "indices": added(F.astype("<u2").ravel(), "SCALAR", 5123),
        "targets": [{"POSITION": X}],
    }
    samplers = [{"input": times, "output": turns}, {"input": times, "output": times}, {"input": times, "output": turns}]
    aims = [(1, "rotation"), (0, "weights"), (0, "rotation")]
    channels = [{"sampler": k, "target": {"node": node, "path": path}} for k, (node, path) in enumerate(aims)]
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0, "skin": 0}, {}],
        "meshes": [{"primitives": [primitive], "weights": [0]}], "skins": [{"joints": [1]}],
        "animations": [{"name": "walk", "samplers": samplers, "channels": channels}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(body)}],
    }  # fmt: skip
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(body), b"BIN\0") + body
    return [b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks]


def _zip() -> list[bytes]:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("walk/frame_1.off", _off()[0])
        archive.writestr("walk/frame_2.off", _off()[0])
    return [stream.getvalue()]


def _packed(save: Callable[..., None] = np.savez, **arrays: Any) -> bytes:
    stream = io.BytesIO()
    save(stream, **arrays)
    return stream.getvalue()


def _npz() -> list[bytes]:
    offsets = {"vertex_offsets": np.array([0, 4, 8]), "face_offsets": np.array([0, 4])}
    arrays = {"vertices": np.concatenate([V, V + 1]).astype("f4"), "faces": F, **offsets, "fps": 25.0, "unit": "mm"}
    return [_packed(**arrays), _packed(np.savez_compressed, **arrays)]


def _npy() -> list[bytes]:
    stream = io.BytesIO()
    np.save(stream, np.arange(8, dtype="f4").reshape(2, 2, 2))
    return [stream.getvalue()]


def _volume_npz() -> list[bytes]:
    return [_packed(field=np.arange(8, dtype="f4").reshape(2, 2, 2), origin=np.zeros(3), voxel=1.0)]


def _nrrd() -> list[bytes]:
    head = "NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
    head += "space directions: (1,0,0) (0,1,0) (0,0,1)\nendian: little\nencoding: {}\nspace origin: (0,0,0)\n\n"
    return [
        head.format("raw").encode() + np.arange(8, dtype="<f4").tobytes(),
        head.format("ascii").encode() + b"0 1 2 3 4 5 6 7\n",
    ]


def _tiff() -> list[bytes]:
    import tifffile

    stream = io.BytesIO()
    tifffile.imwrite(stream, np.arange(8, dtype="f4").reshape(2, 2, 2), photometric="minisblack")
    return [stream.getvalue()]


def _calibration_json() -> list[bytes]:
    lens = {"K": [[100, 0, 2], [0, 100, 2], [0, 0, 1]], "R": np.eye(3).tolist(), "t": [0, 0, 5]}
    cameras = [{"name": "cam_00", "size": [4, 4], **lens}, {"name": "cam_01", "size": [4, 4], "P": np.eye(3, 4).tolist()}]
    return [json.dumps({"format": "kinetree.cameras/1", "unit": "m", "fps": 25, "cameras": cameras}).encode()]


def _calibration_yaml() -> list[bytes]:
    def matrix(name: str, rows: int, columns: int, values: str) -> str:
        return f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {values} ]\n"

    text = '%YAML:1.0\n---\nnames:\n   - "01"\n' + matrix("K_01", 3, 3, "100, 0, 2, 0, 100, 2, 0, 0, 1")
    text += (
        matrix("R_01", 3, 1, "0, 0, 0") + matrix("Rot_01", 3, 3, "1, 0, 0, 0, 1, 0, 0, 0, 1") + matrix("T_01", 3, 1, "0, 0, 5")
    )
    return [text.encode()]


def _calibration_npz() -> list[bytes]:
    return [_packed(P=np.stack([np.eye(3, 4)] * 2), size=np.array([4, 4]))]


def _png() -> list[bytes]:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(np.eye(4, dtype=np.uint8) * 255).save(stream, format="png")
    return [stream.getvalue()]


def _bvh() -> list[bytes]:
    return [b"""HIERARCHY
ROOT hips
{
 OFFSET 0 0 0
 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
 JOINT knee
 {
  OFFSET 0 -1 0
  CHANNELS 3 Zrotation Xrotation Yrotation
  End Site
  {
   OFFSET 0 -1 0
  }
 }
}
MOTION
Frames: 2
Frame Time: 0.04
0 0 0 0 0 0 0 0 0
0 0 0 10 0 0 20 0 0
"""]  # fmt: skip


def _truth() -> list[bytes]:
    names, parents, kinds = ("hips", "knee", "toe"), (None, "hips", "knee"), ("joint", "joint", "tip")
    joints = [{"name": n, "parent": p, "kind": k, "turns_deg": 40} for n, p, k in zip(names, parents, kinds, strict=True)]
    truth = {"unit": "m", "fps": 25, "height": 2, "frames": [0, 1], "joints": joints, "positions": [np.eye(3).tolist()] * 2}
    own = [{"name": f"j{i}", "parent": i - 1 if i else None, "kind": k} for i, k in enumerate(("root", "joint", "leaf"))]
    return [json.dumps(truth).encode(), json.dumps({**truth, "format": "kinetree.skeleton/2", "joints": own}).encode()]


def _figure() -> list[bytes]:
    return [b"""name: body
fps: 5
unit: mm
joints:
  - {name: trunk, position: [0, 0, 0], radius: 2.0}
  - {name: knee, parent: trunk, position: [6, 0, 0], radii: [1.0, 0.9]}
  - {name: toe, parent: knee, position: [10, 0, 0], radii: [0.9, 0.6]}
motions:
  kick:
    knee: [{axis: [0, 0, 1], amplitude: 40, frequency: 1.0}]
"""]  # fmt: skip


def _config() -> list[bytes]:
    text = b"source:\n  input: scans/*.ply\n  frames: '0:10'\nsequence: {fps: 25, unit: mm}\noutput: walk\n"
    return [text + b"compute: {executor: sync}\n", b"geodesics: &x {bases: 40}\nextends: demo\noutput: walk\n"]


# ── readers ─────────────────────────────────────────────────────────────────────────────────────────────────────────


def _read_npz(path: Path) -> Any:
    from kinetree.tasks.numerics.input.source import read_npz

    frames = read_npz(path)
    return [frames.mesh(t) for t in range(min(len(frames), 8))]


def _read_mesh(path: Path) -> Any:
    from kinetree.tasks.numerics.input.formats import read_mesh

    return read_mesh(path)


def _read_animated(path: Path) -> Any:
    from kinetree.tasks.numerics.input.animated import read_animated

    frames = read_animated(path)
    return [frames.mesh(t) for t in range(min(len(frames), 8))]


def _read_volume(path: Path) -> Any:
    from kinetree.tasks.numerics.input.volumes import read_volume

    return read_volume(path)


def _read_calibration(path: Path) -> Any:
    from kinetree.tasks.numerics.input.calibration import read_calibration

    return read_calibration([path])


@cache
def _camera() -> Any:
    from kinetree.tasks.numerics.input.calibration import Calibration

    return Calibration(("cam_00",), np.eye(3, 4)[None], (None,))


def _read_mask(path: Path) -> Any:
    from kinetree.tasks.numerics.input.silhouettes import read_masks

    return read_masks([path], _camera())


def _read_masks(path: Path) -> Any:
    from kinetree.tasks.numerics.input.silhouettes import read_packed_masks

    return read_packed_masks(path, _camera())


def _read_truth(path: Path) -> Any:
    from kinetree.errors.small_text import small_text
    from kinetree.tasks.numerics.results.truth import read_truth

    return read_truth(small_text(path), path.name)


def _read_figure(path: Path) -> Any:
    from kinetree.tasks.input.synth import _read
    from kinetree.tasks.numerics.input.synth.figures import Figure

    return Figure.of(_read(path))


def _read_config(path: Path) -> Any:
    from kinetree.pipeline.settings.blocks import read_yaml

    return read_yaml(path)


PARSERS: dict[str, Parser] = {
    "ply": Parser(_read_mesh, ".ply", _ply),
    "obj": Parser(_read_mesh, ".obj", _obj),
    "off": Parser(_read_mesh, ".off", _off),
    "stl": Parser(_read_mesh, ".stl", _stl),
    "glb": Parser(_read_mesh, ".glb", _glb),
    "animated-glb": Parser(_read_animated, ".glb", _animated_glb),
    "zip": Parser(_read_animated, ".zip", _zip),
    "npz": Parser(_read_npz, ".npz", _npz),
    "volume-npy": Parser(_read_volume, ".npy", _npy),
    "volume-npz": Parser(_read_volume, ".npz", _volume_npz),
    "volume-nrrd": Parser(_read_volume, ".nrrd", _nrrd),
    "volume-tiff": Parser(_read_volume, ".tif", _tiff),
    "mask": Parser(_read_mask, ".png", _png),
    "masks-npz": Parser(_read_masks, ".npz", lambda: [_packed(silhouettes=np.eye(4, dtype=np.uint8)[None])]),
    "calibration-json": Parser(_read_calibration, ".json", _calibration_json),
    "calibration-yaml": Parser(_read_calibration, ".yml", _calibration_yaml),
    "calibration-npz": Parser(_read_calibration, ".npz", _calibration_npz),
    "truth-json": Parser(_read_truth, ".json", _truth),
    "truth-bvh": Parser(_read_truth, ".bvh", _bvh),
    "figure": Parser(_read_figure, ".yaml", _figure),
    "config": Parser(_read_config, ".yaml", _config),
}


def tried(name: str, data: bytes, folder: Path) -> bool:
    """Reads one file: True if it is one, False if it was refused as the user's input; anything else is raised."""
    from kinetree.errors import InputError

    parser = PARSERS[name]
    path = folder / f"frame_1{parser.suffix}"
    path.write_bytes(data)
    try:
        parser.read(path)
    except InputError as error:
        if not str(error).strip():
            raise RuntimeError("a refusal without words") from error
        return False
    return True


# ── mutants without atheris, for a short round ──────────────────────────────────────────────────────────────────────

NUMBERS = (b"0", b"-1", b"1e309", b"nan", b"0x10", b"4294967296", b"9" * 400, b"1.5", b"")
MARKS = (b"\0", b"\xff", b"\n", b"{", b"[" * 200, b"&a", b"*a", b"!!python/object:os.system", b'"', b"/etc/passwd", b" ")


def mutants(seed: bytes, count: int, rng: random.Random) -> Iterator[bytes]:
    """A file with one to three faults: bytes altered, cut, doubled, moved, numbers replaced, marks put in."""
    for _ in range(count):
        data = seed
        for _ in range(rng.randint(1, 3)):
            data = _mutant(data, rng)
        yield data


def _mutant(data: bytes, rng: random.Random) -> bytes:
    a, b = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    match rng.randrange(7):
        case 0:
            return data[:a] + bytes([rng.randrange(256)]) + data[a + 1 :]
        case 1:
            return data[:a]
        case 2:
            return data[:a] + data[b:]
        case 3:
            return data[:b] + data[a:b] + data[b:]
        case 4:
            return data[:a] + rng.choice(MARKS) + data[a:]
        case 5:
            return data[:a] + struct.pack("<I", rng.choice((0, 1, 2**31, 2**32 - 1))) + data[a + 4 :]
        case _:
            numbers = list(re.finditer(rb"-?\d+(\.\d+)?", data))
            if not numbers:
                return data
            number = rng.choice(numbers)
            return data[: number.start()] + rng.choice(NUMBERS) + data[number.end() :]


# ── one parser in a process of its own ──────────────────────────────────────────────────────────────────────────────


def fuzz(name: str, runs: int, seconds: int, work: Path) -> None:
    """Never returns: libFuzzer ends the process."""
    import atheris

    with atheris.instrument_imports(include=list(INSTRUMENTED)):
        for seed in PARSERS[name].seeds():
            with tempfile.TemporaryDirectory() as folder:
                tried(name, seed, Path(folder))
    corpus = work / name
    corpus.mkdir(parents=True, exist_ok=True)
    for i, seed in enumerate(PARSERS[name].seeds()):
        (corpus / f"seed-{i}").write_bytes(seed)
    scratch = Path(tempfile.mkdtemp(dir="/dev/shm" if Path("/dev/shm").is_dir() else None))
    options = [
        f"-runs={runs}",
        f"-max_total_time={seconds}",
        f"-timeout={SECONDS}",
        f"-rss_limit_mb={MEGABYTES}",
        f"-max_len={LONGEST}",
    ]
    options += [f"-artifact_prefix={work / name}.", "-print_final_stats=1", "-seed=1"]

    def one(data: bytes) -> None:
        with contextlib.redirect_stdout(None):
            tried(name, data, scratch)

    atheris.Setup([sys.argv[0], *options, str(corpus)], one)
    atheris.Fuzz()


def measured(name: str, runs: int, seconds: int, work: Path) -> dict[str, Any]:
    """One parser in a process of its own."""
    command = [
        sys.executable,
        __file__,
        "--child",
        "--parsers",
        name,
        "--runs",
        str(runs),
        "--seconds",
        str(seconds),
        "--work",
        str(work),
    ]
    before = set(work.glob(f"{name}.*"))
    done = subprocess.run(
        command, capture_output=True, text=True, errors="replace", check=False, env={**os.environ, "PYTHONWARNINGS": "ignore"}
    )
    (work / f"{name}.log").write_text(done.stderr)
    stats = {key: int(value) for key, value in re.findall(r"stat::(\w+):\s+(\d+)", done.stderr)}
    edges = [int(n) for n in re.findall(r"cov: (\d+)", done.stderr)]
    crashes = sorted(path.name for path in set(work.glob(f"{name}.*")) - before if path.suffix != ".log")
    return {
        "parser": name, "runs": stats.get("number_of_executed_units", 0), "per_second": stats.get("average_exec_per_sec", 0),
        "edges": max(edges, default=0), "megabytes": stats.get("peak_rss_mb", 0), "failures": crashes,
        "reason": "" if done.returncode == 0 else done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "no word",
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--parsers", nargs="*", default=list(PARSERS), choices=list(PARSERS))
    parser.add_argument("--runs", type=int, default=1_000_000)
    parser.add_argument("--seconds", type=int, default=0)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--replay", type=Path)
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.child:
        fuzz(args.parsers[0], args.runs, args.seconds, args.work)
    with tempfile.TemporaryDirectory() as scratch:
        if args.replay is not None:
            print("read" if tried(args.parsers[0], args.replay.read_bytes(), Path(scratch)) else "refused")
            return
        work = (args.work or Path(scratch)).absolute()
        work.mkdir(parents=True, exist_ok=True)
        failed = False
        print("| parser | executions | a second | edges | MB | failures |\n|---|---|---|---|---|---|", flush=True)
        for name in args.parsers:
            row = measured(name, max(1, args.runs // len(args.parsers)), args.seconds, work)
            failed |= bool(row["failures"] or row["reason"])
            said = f"{len(row['failures'])}" + (f": {row['reason']}" if row["reason"] else "")
            print(
                f"| {name} | {row['runs']} | {row['per_second']} | {row['edges']} | {row['megabytes']} | {said} |", flush=True
            )
    sys.exit(failed)


if __name__ == "__main__":
    main()
