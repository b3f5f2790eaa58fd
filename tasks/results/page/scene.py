"""The moving body as the page's player reads it: what is where in one block of bytes, and the block itself."""

import base64
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Floats
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.geometry.decimation import decimated
from kinetree.tasks.numerics.results.scene import Lattice, evenly_spread, part_colouring
from kinetree.tasks.results.plots.drawing import view

PALETTE = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#7F7F7F")
"""Okabe and Ito's, grey for black; parts that touch have other colours."""


@dataclass(frozen=True)
class Limits:
    """How much of a sequence a page can hold and still open at once.

    frames   : frames that play
    vertices : of the aligned mesh
    sighted  : vertices of an input mesh
    """

    frames: int = 90
    vertices: int = 4000
    sighted: int = 2500


Ints = NDArray[np.int64]


class Scene(NamedTuple):
    """What the player reads: a description that is JSON, arrays in one compressed block, and what was left out."""

    told: dict[str, Any]
    block: str
    omitted: tuple[str, ...]


def scene(
    skeleton: Skeleton,
    aligned: Mapping[int, Alignment],
    projections: Mapping[int, Projection],
    meshes: Mapping[int, Mesh],
    leaves: Leaves,
    intervals: Intervals,
    limits: Limits,
    up: int = 1,
) -> Scene:
    """The body playing, reduced to what a page can hold.

    Vertices are turned so that across is x, up is y and towards the eye is z.

    up : see `view`
    """
    shown = evenly_spread(len(skeleton.frames), limits.frames)
    frames = [skeleton.frames[t] for t in shown]
    axes = view([meshes[frame].vertices for frame in frames], up)
    kept, faces = decimated(np.array(skeleton.vertices), skeleton.faces, limits.vertices)
    positions = np.stack([aligned[frame].vertices[kept] @ axes for frame in frames])
    sights = _sights([meshes[f] for f in frames], [projections[f] for f in frames], skeleton, limits.sighted)
    own = [s.faces for s, t in zip(sights, [None, *sights], strict=False) if t is None or s.faces is not t.faces]
    corners = [positions.reshape(-1, 3), *(s.vertices @ axes for s in sights)]
    low, high = np.min([c.min(axis=0) for c in corners], axis=0), np.max([c.max(axis=0) for c in corners], axis=0)
    lattice = Lattice.around(low, high)
    arrays: dict[str, NDArray[Any]] = {
        "positions": lattice.levels(positions),
        "faces": faces.astype(np.uint32),
        "label": skeleton.label[kept].astype(np.int16),
        "joints": (skeleton.positions[shown] @ axes).astype(np.float32),
        "input_vertices": lattice.levels(np.concatenate([s.vertices for s in sights]) @ axes),
        "input_faces": np.concatenate(own).astype(np.uint32),
        "input_label": np.concatenate([s.label for s in sights]).astype(np.int16),
        "input_vertex_offsets": _offsets([len(s.vertices) for s in sights]),
        "input_face_spans": _spans([s.faces for s in sights]),
    }
    if len(leaves.positions):
        at = [leaves.frames.index(frame) for frame in frames]
        arrays["leaves"] = (leaves.positions[:, at].transpose(1, 0, 2) @ axes).astype(np.float32)
    told, block = packed(arrays)
    colours = part_colouring(np.asarray(skeleton.label), skeleton.faces, len(PALETTE))
    described = {
        "frames": frames,
        "fps": skeleton.fps,
        "rate": (skeleton.fps or 25.0) * len(frames) / len(skeleton.frames),
        "unit": skeleton.unit,
        "reach": float(np.linalg.norm(high - low)),
        "size": float(np.median(np.linalg.norm(np.ptp(positions, axis=1), axis=1))),
        "centre": positions.mean(axis=(0, 1)).tolist(),
        "low": lattice.low.tolist(),
        "scale": lattice.scale,
        "palette": [PALETTE[c] for c in colours] or [PALETTE[0]],
        "joints": [
            {"name": name, "parent": parent, "kind": kind}
            for name, parent, kind in zip(skeleton.names, skeleton.parents, skeleton.kinds, strict=True)
        ],
        "intervals": _starts(intervals, skeleton.frames, shown),
        "arrays": told,
    }
    return Scene(described, block, _omitted(skeleton, meshes, frames, len(kept), limits))


class _Sight(NamedTuple):
    vertices: Floats
    faces: Ints
    label: Ints


def _sights(meshes: list[Mesh], projections: list[Projection], skeleton: Skeleton, count: int) -> list[_Sight]:
    """Every frame's own mesh, coarser, with the labels that come back to its vertices.

    Frames of the same faces are made coarser alike and share them, so that a page holds them once.
    """
    sights: list[_Sight] = []
    last, kept, faces = None, np.zeros(0, np.int64), np.zeros((0, 3), np.int64)
    for mesh, projection in zip(meshes, projections, strict=True):
        if last is None or not np.array_equal(mesh.faces, last):
            last = mesh.faces
            kept, faces = decimated(np.array(mesh.vertices), mesh.faces, count)
        label = np.full(len(mesh.vertices), -1, np.int64)
        seen = (projection.face >= 0) & (mesh.vertex_of_input >= 0)
        corner = np.argmax(projection.share, axis=1)
        label[mesh.vertex_of_input[seen]] = skeleton.label[skeleton.faces[projection.face[seen], corner[seen]]]
        sights.append(_Sight(np.asarray(mesh.vertices)[kept], faces, label[kept]))
    return sights


def packed(arrays: Mapping[str, NDArray[Any]]) -> tuple[dict[str, dict[str, Any]], str]:
    """Where each array lies in one block, and the block: deflated, in base64. Each begins at a multiple of 4 bytes."""
    told: dict[str, dict[str, Any]] = {}
    pieces: list[bytes] = []
    offset = 0
    for name, array in arrays.items():
        raw = np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<")).tobytes()
        told[name] = {"dtype": str(array.dtype), "shape": list(array.shape), "offset": offset}
        raw += bytes(-len(raw) % 4)
        pieces.append(raw)
        offset += len(raw)
    return told, base64.b64encode(zlib.compress(b"".join(pieces), 6)).decode()


def _offsets(counts: list[int]) -> NDArray[np.uint32]:
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.uint32)


def _spans(faces: list[Ints]) -> NDArray[np.uint32]:
    """(frame, 2) where each frame's faces begin and end where those that are the very same as the last are held once."""
    spans = [(0, 0)]
    for k, F in enumerate(faces):
        spans.append(spans[-1] if k and F is faces[k - 1] else (spans[-1][1], spans[-1][1] + len(F)))
    return np.array(spans[1:], np.uint32)


def _starts(intervals: Intervals, frames: tuple[int, ...], shown: Ints) -> list[dict[str, int]]:
    """Where each interval begins, as a number of the frame and as its place among those shown."""
    starts = []
    for begin, end in zip(intervals.begin, intervals.end, strict=True):
        at = int(np.searchsorted(shown, begin))
        starts.append({"at": min(at, len(shown) - 1), "begin": frames[int(begin)], "end": frames[int(end)]})
    return starts


def _omitted(skeleton: Skeleton, meshes: Mapping[int, Mesh], frames: list[int], kept: int, limits: Limits) -> tuple[str, ...]:
    told = []
    if len(frames) < len(skeleton.frames):
        told.append(f"{len(frames)} of {len(skeleton.frames)} frames play here")
    if kept < len(skeleton.vertices):
        told.append(f"the aligned mesh has {kept} of its {len(skeleton.vertices)} vertices")
    largest = max(len(meshes[frame].vertices) for frame in frames)
    if largest > limits.sighted:
        told.append(f"input meshes are reduced to about {limits.sighted} of up to {largest} vertices")
    return tuple(told)
