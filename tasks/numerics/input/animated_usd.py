"""Meshes of a USD stage over time, skinned ones included, as a sequence.

Source: UsdGeom and UsdSkel of OpenUSD (the extra `usd`), which read the stage and bake its skins.
"""

import math
import zipfile
from importlib import import_module
from pathlib import Path
from typing import IO, Any

import numpy as np

from kinetree.errors import SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.formats import checked

_UNITS = {1.0: "m", 0.01: "cm", 0.001: "mm"}
"""Units by their length in metres; any other stage is brought to metres."""
_MOST_FRAMES = 100_000
_MOST_VERTICES = 50_000_000
_MOST_FACES = 2 * _MOST_VERTICES
_MOST_PRIMS = 100_000
_DEEPEST = 1000
"""Prims, lists and dictionaries within each other; bodies have some tens."""
_PIECE_BYTES = 2**20
_STEPS = np.array([(chr(c) in "{[(") - (chr(c) in "}])") for c in range(256)], dtype=np.int8)
"""How far each byte opens brackets."""


class AnimatedUsd:
    """The frames of a USD stage, one a time code.

    fps  : time codes a second
    unit : of the stage
    """

    def __init__(self, path: Path) -> None:
        """Opens the stage; raises SourceError where it cannot be, needs other files, or does not change over time."""
        self.name = str(path)
        try:
            pxr = {name: import_module(f"pxr.{name}") for name in ("Gf", "Pcp", "Sdf", "Usd", "UsdGeom", "UsdSkel")}
        except ImportError:
            raise SourceError(f"{path}: USD is read by usd-core; pip install 'kinetree[usd]'") from None
        self._geom, self._usd = pxr["UsdGeom"], pxr["Usd"]
        stage = self._stage = self._opened(path, pxr)
        first, last = stage.GetStartTimeCode(), stage.GetEndTimeCode()
        if not stage.HasAuthoredTimeCodeRange() or not 0 < last - first < _MOST_FRAMES:
            raise SourceError(
                f"{path}: its stage has {last - first + 1:g} time codes; at least two are needed, at most {_MOST_FRAMES}"
            )
        self._first, self._frames = first, int(last - first) + 1
        self.fps = float(stage.GetTimeCodesPerSecond())
        metres = float(self._geom.GetStageMetersPerUnit(stage))
        if not (0 < self.fps < math.inf and 0 < metres < math.inf):
            raise SourceError(
                f"{path}: its stage has {self.fps:g} time codes a second and units of {metres:g} m; both must be positive"
            )
        self.unit = next((unit for length, unit in _UNITS.items() if abs(metres / length - 1) < 1e-6), "m")
        self._scale = 1.0 if abs(metres / {u: m for m, u in _UNITS.items()}[self.unit] - 1) < 1e-6 else metres
        pxr["UsdSkel"].BakeSkinning(stage.Traverse())
        self._meshes = [self._geom.Mesh(p) for p in stage.Traverse() if p.IsA(self._geom.Mesh)]
        if not self._meshes:
            raise SourceError(f"{path}: no mesh on its stage; a surface is needed")

    def _opened(self, path: Path, pxr: Any) -> Any:
        """The stage, with a layer of its own for what is baked."""
        is_package = path.suffix.lower() == ".usdz"
        _refuse_deep(path)
        try:
            # the library remembers a layer by its path, also after the file has changed
            layer = pxr["Sdf"].Layer.FindOrOpen(str(path)) if is_package else pxr["Sdf"].Layer.OpenAsAnonymous(str(path))
            if is_package and layer is not None:
                layer.Reload(True)
            outside = [] if layer is None or is_package else list(layer.GetCompositionAssetDependencies())
        except Exception as error:  # raised by boost as its own kinds of exception
            raise SourceError(f"{path}: cannot be read as USD ({str(error).strip().splitlines()[-1][:200]})") from None
        if layer is None:
            raise SourceError(f"{path}: cannot be read as USD; the file is damaged or something else")
        if outside:
            raise SourceError(_composed(path, outside[0]))
        if _has_more_prims(layer, pxr["Pcp"], pxr["Sdf"].Path.absoluteRootPath):
            raise SourceError(
                f"{path}: its stage has more than {_MOST_PRIMS} prims, as often as they are inherited or referred to; no body"
                " needs as many"
            )
        baked = pxr["Sdf"].Layer.CreateAnonymous()
        baked.timeCodesPerSecond = layer.timeCodesPerSecond  # else its time codes would be stretched
        stage = self._usd.Stage.Open(layer, baked)
        own = str(path.resolve())
        foreign = [used.realPath for used in stage.GetUsedLayers() if not (used.anonymous or _is_of(used.realPath, own))]
        if foreign:  # a package whose layers refer to what lies outside it
            raise SourceError(_composed(path, foreign[0]))
        stage.SetEditTarget(stage.GetSessionLayer())
        return stage

    def __len__(self) -> int:
        return self._frames

    def mesh(self, t: int) -> tuple[Floats, Faces]:
        """V (vertex, xyz) and F (face, corner) of frame t; SourceError where there is none, MeshError as `checked`."""
        if not 0 <= t < len(self):
            raise SourceError(f"{self.name}: there is no frame {t}; frames are 0 to {len(self) - 1}")
        code = self._usd.TimeCode(self._first + t)
        placed = self._geom.XformCache(code)
        V: list[Floats] = [np.empty((0, 3))]
        F: list[Any] = [np.empty((0, 3), np.int64)]
        begin, faces = 0, 0
        for mesh in self._meshes:
            if mesh.ComputeVisibility(code) == "invisible":
                continue
            X = np.array(mesh.GetPointsAttr().Get(code) or np.empty((0, 3)), dtype=np.float64).reshape(-1, 3)
            corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(code) or (), dtype=np.int64)
            counts = np.array(mesh.GetFaceVertexCountsAttr().Get(code) or (), dtype=np.int64)
            M = np.array(placed.GetLocalToWorldTransform(mesh.GetPrim()))
            turned = (mesh.GetOrientationAttr().Get() == "leftHanded") != (np.linalg.det(M[:3, :3]) < 0)
            G = _fans(counts, corners, self.name)
            V.append((X @ M[:3, :3] + M[3, :3]) * self._scale)
            F.append((G[:, ::-1] if turned else G) + begin)
            begin, faces = begin + len(X), faces + len(G)
            if begin > _MOST_VERTICES or faces > _MOST_FACES:
                most = f"{_MOST_VERTICES} vertices or {_MOST_FACES} faces"
                raise SourceError(f"{self.name}, frame {t}: more than {most}; no frame needs as many")
        return checked(np.concatenate(V), np.concatenate(F), f"{self.name}, frame {t}")


def _has_more_prims(layer: Any, pcp: Any, root: Any) -> bool:
    """Whether a stage would have more prims than any body needs; they are composed one by one, a stage composes them all."""
    cache, waiting, prims = pcp.Cache(pcp.LayerStackIdentifier(layer), usd=True), [root], 0
    while waiting and prims <= _MOST_PRIMS:
        path = waiting.pop()
        index, _ = cache.ComputePrimIndex(path)
        if index.hasAnyPayloads and not cache.IsPayloadIncluded(path):
            cache.RequestPayloads([path], [])
            index, _ = cache.ComputePrimIndex(path)
        names, _ = index.ComputePrimChildNames()
        waiting += [path.AppendChild(name) for name in names]
        prims += 1
    return prims > _MOST_PRIMS


def _composed(path: Path, other: str) -> str:
    """What is said of a stage that needs other files."""
    return f"{path}: is composed of other files ({other!r}), which are not read; flatten it (usdcat --flatten)"


def _is_of(layer: str, package: str) -> bool:
    """Whether a layer is a package or lies in it, which is written package[layer]."""
    return layer == package or layer.startswith(f"{package}[")


def _refuse_deep(path: Path) -> None:
    """Refuses text that is nested so deeply that the library would end the process; it does at about 10,000."""
    try:
        if not zipfile.is_zipfile(path):
            with path.open("rb") as file:
                depth = _text_depth(file)
        else:
            with zipfile.ZipFile(path) as archive:
                stored = [i for i in archive.infolist() if i.compress_type == zipfile.ZIP_STORED]  # no other is read
                depth = max((_text_depth(file) for i in stored for file in [archive.open(i)]), default=0)
    except Exception as error:  # zipfile raises many kinds for altered bytes
        raise SourceError(f"{path}: cannot be read as USD ({type(error).__name__}: {error})") from None
    if depth > _DEEPEST:
        raise SourceError(f"{path}: its prims or values are nested more than {_DEEPEST} deep; no body needs as many")


def _text_depth(file: IO[bytes]) -> int:
    """How many brackets of a text are open at once; 0 of what is no text of USD."""
    piece, depth, most = file.read(_PIECE_BYTES), 0, 0
    if not piece.lstrip().startswith(b"#"):
        return 0
    while piece and most <= _DEEPEST:
        open_ = depth + np.cumsum(_STEPS[np.frombuffer(piece, np.uint8)], dtype=np.int64)
        depth, most = int(open_[-1]), max(most, int(open_.max()))
        piece = file.read(_PIECE_BYTES)
    return most


def _fans(counts: Any, corners: Any, name: str) -> Any:
    """(face, corner) of polygons, each cut into triangles about its first corner."""
    if (counts < 0).any() or counts.sum() != len(corners):
        raise SourceError(f"{name}: faces of {counts.sum()} corners, of which {len(corners)} are there; the file is damaged")
    begin = np.cumsum(counts) - counts
    many = np.maximum(counts - 2, 0)
    face = np.repeat(np.arange(len(counts)), many)
    k = np.arange(many.sum()) - np.repeat(np.cumsum(many) - many, many)
    return np.stack([corners[begin[face]], corners[begin[face] + k + 1], corners[begin[face] + k + 2]], axis=1).reshape(-1, 3)
