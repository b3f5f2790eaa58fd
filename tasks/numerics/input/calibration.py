"""Calibration of several cameras: JSON, npz, or OpenCV's YAML, read as projection matrices.

All agree that (column·w, row·w, w) = P (x, y, z, 1) with pixel centres at whole numbers, the first pixel at (0, 0), rows
downwards, and w > 0 in front of the camera; P = K [R | t].
"""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from kinetree.errors import SourceError
from kinetree.errors.small_text import BoundedLoader, small_json, small_text, small_yaml
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.input.npz import npz_arrays, npz_shapes
from kinetree.tasks.numerics.input.source import natural_order

FORMAT = "kinetree.cameras/1"
NAMES = tuple(f"{stem}{suffix}" for suffix in (".json", ".npz", ".yml", ".yaml") for stem in ("calibration", "cameras"))
"""File names that are looked for, in this order; then the pair intri.yml and extri.yml."""
LARGEST = 64_000_000
"""Bytes of a calibration file that is read."""
RIGHT_ANGLE = 1e-3
"""How far R Rᵀ may be from the identity."""


@dataclass(frozen=True)
class Calibration:
    """Cameras by name.

    names : as the file says, or cam_00, cam_01, … where it says none
    P     : (camera, 3, 4)
    sizes : (rows, columns) of each camera's images; None where the file does not say
    unit  : of length; None where the file does not say
    fps   : frames a second; None where the file does not say
    """

    names: tuple[str, ...]
    P: Floats
    sizes: tuple[tuple[int, int] | None, ...]
    unit: str | None = None
    fps: float | None = None


def calibration_files(folder: Path) -> list[Path]:
    """The calibration of a folder: one file, or the pair intri.yml and extri.yml; empty where there is none."""
    for name in NAMES:
        if (folder / name).is_file():
            return [folder / name]
    pair = [folder / f"{name}.yml" for name in ("intri", "extri")]
    return pair if all(path.is_file() for path in pair) else []


def read_calibration(files: Sequence[Path]) -> Calibration:
    """The cameras in a file, or in several that complete each other.

    raises : SourceError that names file and camera
    """
    where = " and ".join(map(str, files))
    for path in files:
        if path.stat().st_size > LARGEST:
            raise SourceError(f"{path}: {path.stat().st_size} bytes are no calibration; a camera needs less than a kilobyte")
    try:
        calibration = _READERS[files[0].suffix.lower()](files, where)
    except SourceError:
        raise
    except Exception as error:
        raise SourceError(f"{where}: cannot be read as a calibration ({type(error).__name__}: {error})") from error
    if len(calibration.names) != len(set(calibration.names)):
        raise SourceError(f"{where}: two cameras have one name; there are {', '.join(calibration.names)}")
    return calibration


def written_calibration(calibration: Calibration) -> str:
    """The calibration as JSON, which `read_calibration` reads back."""
    cameras = [
        {"name": name, "size": None if size is None else [size[1], size[0]], "P": P.tolist()}
        for name, size, P in zip(calibration.names, calibration.sizes, calibration.P, strict=True)
    ]
    return json.dumps({"format": FORMAT, "unit": calibration.unit, "fps": calibration.fps, "cameras": cameras}, indent=1)


def _json(files: Sequence[Path], where: str) -> Calibration:
    document = small_json(small_text(files[0], SourceError, LARGEST), where, SourceError)
    if not isinstance(document, dict) or not isinstance(document.get("cameras"), list) or not document["cameras"]:
        what = 'one entry a camera with "name", "size" and "P", or "K", "R" and "t"'
        raise SourceError(f'{where}: no list "cameras"; {FORMAT} has {what}')
    names, P, sizes = [], [], []
    for c, camera in enumerate(document["cameras"]):
        name = str(camera.get("name", f"cam_{c:02d}"))
        names.append(name)
        P.append(_projection(camera, f"{where}: camera {name}"))
        size = camera.get("size")
        sizes.append(None if size is None else (int(size[1]), int(size[0])))
        if size is not None and min(sizes[-1] or ()) < 1:
            raise SourceError(f"{where}: camera {name}: size is {size}; width and height of its images in pixels are needed")
    fps, unit = document.get("fps"), document.get("unit")
    if fps is not None and not 0 < float(fps) < np.inf:
        raise SourceError(f"{where}: fps is {fps}; one positive number of frames a second is needed, or null")
    if unit is not None and not isinstance(unit, str):
        raise SourceError(f"{where}: unit is {unit}; the name of a unit of length is needed, such as m, or null")
    return Calibration(tuple(names), np.array(P), tuple(sizes), unit, None if fps is None else float(fps))


def _npz(files: Sequence[Path], where: str) -> Calibration:
    arrays = npz_arrays(files[0], ("P", "size"), SourceError, LARGEST)
    if "P" not in arrays:
        raise SourceError(f"{where}: no array P (camera, 3, 4); there are {', '.join(npz_shapes(files[0])) or 'none'}")
    matrices = np.asarray(arrays["P"], dtype=np.float64)
    size = arrays["size"].reshape(-1) if "size" in arrays else None
    if matrices.ndim != 3 or matrices.shape[1:] != (3, 4) or not len(matrices):
        raise SourceError(f"{where}: P is {matrices.shape}; (camera, 3, 4) is needed")
    names = tuple(f"cam_{c:02d}" for c in range(len(matrices)))
    P = [_projection({"P": M}, f"{where}: camera {name}") for name, M in zip(names, matrices, strict=True)]
    one = None if size is None else (int(size[0]), int(size[1]))
    return Calibration(names, np.array(P), (one,) * len(P))


def _opencv(files: Sequence[Path], where: str) -> Calibration:
    """Nodes K_name, Rot_name or R_name (a matrix or a rotation vector), T_name and dist_name or P_name, for every name."""
    nodes: dict[str, Any] = {}
    for path in files:
        text = re.sub(r"^%YAML:?\s?\d\.\d\s*(---)?", "", small_text(path, SourceError, LARGEST))
        nodes.update(small_yaml(text, str(path), SourceError, _OpenCV) or {})
    listed = nodes.get("names") or sorted({k.partition("_")[2] for k in nodes if k.startswith(("K_", "P_"))}, key=natural_order)
    if not listed:
        raise SourceError(f"{where}: no list names and no nodes K_name or P_name, of which a calibration is made")
    P = []
    for name in listed:
        own = {key: nodes.get(f"{node}_{name}") for key, node in (("P", "P"), ("K", "K"), ("t", "T"), ("distortion", "dist"))}
        own["R"] = nodes.get(f"Rot_{name}", nodes.get(f"R_{name}"))
        P.append(_projection({k: v for k, v in own.items() if v is not None}, f"{where}: camera {name}"))
    sizes = tuple(_opencv_size(nodes, str(name)) for name in listed)
    return Calibration(tuple(map(str, listed)), np.array(P), sizes)


def _opencv_size(nodes: Mapping[str, Any], name: str) -> tuple[int, int] | None:
    rows, columns = (nodes.get(f"{key}_{name}", nodes.get(word)) for key, word in (("H", "image_height"), ("W", "image_width")))
    return None if rows is None or columns is None else (int(rows), int(columns))


class _OpenCV(BoundedLoader):
    """Plain YAML and the tag !!opencv-matrix."""


def _matrix(loader: yaml.SafeLoader, node: Any) -> Floats:
    fields = loader.construct_mapping(node, deep=True)
    return np.array(fields["data"], dtype=np.float64).reshape(int(fields["rows"]), int(fields["cols"]))


_OpenCV.add_constructor("tag:yaml.org,2002:opencv-matrix", _matrix)


def _projection(camera: Mapping[str, Any], where: str) -> Floats:
    """P from P, or from K, R and t."""
    distortion = np.ravel(camera.get("distortion", 0.0)).astype(np.float64)
    if (np.abs(distortion) > 1e-12).any():
        raise SourceError(
            f"{where}: lens distortion {distortion.tolist()} is not applied; undistort the masks and leave it out"
        )
    if "P" in camera:
        P = _shaped(camera["P"], (3, 4), "P", where)
    else:
        if missing := [key for key in ("K", "R", "t") if key not in camera]:
            raise SourceError(f"{where}: no {', '.join(missing)}; either P (3 × 4) or K, R and t are needed")
        K, t = _shaped(camera["K"], (3, 3), "K", where), _shaped(np.ravel(camera["t"]), (3,), "t", where)
        P = K @ np.column_stack([_rotation(camera["R"], where), t])
    if abs(np.linalg.det(P[:, :3])) < 1e-12 * np.linalg.norm(P[:, :3]) ** 3 or not np.linalg.norm(P[2, :3]) > 0:
        raise SourceError(f"{where}: the left 3 × 3 of P is singular; such a camera sees no depth, check K and R")
    return P


def _rotation(R: Any, where: str) -> Floats:
    """A rotation from a matrix or a rotation vector."""
    values = np.asarray(R, dtype=np.float64)
    if values.size == 3:
        from scipy.spatial.transform import Rotation

        return np.asarray(Rotation.from_rotvec(values.ravel()).as_matrix())
    matrix = _shaped(values, (3, 3), "R", where)
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > RIGHT_ANGLE:
        raise SourceError(f"{where}: R is no rotation (R Rᵀ is not the identity); rows and columns may be mixed up or scaled")
    return matrix


def _shaped(value: Any, shape: tuple[int, ...], name: str, where: str) -> Floats:
    array = np.asarray(value, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        raise SourceError(f"{where}: {name} has shape {array.shape}, finite numbers {shape} are needed")
    return array


_READERS: dict[str, Callable[[Sequence[Path], str], Calibration]] = {
    ".json": _json,
    ".npz": _npz,
    ".yml": _opencv,
    ".yaml": _opencv,
}
