"""The moving body as the page's player reads it: a description in JSON and one block of compressed arrays."""

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from kinetree.schemas.array import Floats
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.results.coarse_mesh import CoarseMesh
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.arrays import Ints
from kinetree.tasks.numerics.geometry.decimation import decimated
from kinetree.tasks.numerics.results.scene import Lattice
from kinetree.tasks.results.formats.colours import KINDS, NOT_RIGID, PARTS, SURFACE_LEAF, part_palette
from kinetree.tasks.results.formats.rig import carried
from kinetree.tasks.results.plots.drawing import directions

_LEVEL = 4
"""Of deflation: of a body in 108 frames 5.53 MB in 0.17 s, where zlib's own level 6 makes 5.54 MB in 0.49 s."""


@dataclass(frozen=True)
class Limits:
    """Most of a sequence that a page holds, so that it opens quickly.

    frames         : frames that play
    vertices       : vertices of the aligned mesh
    input_vertices : vertices of an input mesh
    """

    frames: int = 90
    vertices: int = 4000
    input_vertices: int = 2500


class Trust(NamedTuple):
    """What a player shows of a result besides its motion.

    labels : (joint,) what people call the joints
    error  : by source frame number, (vertex,) distance of the skinned mesh to the input, mesh unit
    most   : the distance that has the last colour, mesh unit
    share  : the same, share of the diagonal of the body's box
    state  : (frame, joint) 0 trusted, 1 uncertain, 2 wrong
    bound  : (frame, joint) distance from the true joint that nine joints of ten keep, mesh unit, NaN where it is not known;
             None where no error is known
    """

    labels: tuple[str, ...]
    error: Mapping[int, NDArray[np.floating]]
    most: float
    share: float
    state: NDArray[np.integer]
    bound: Floats | None = None


class Scene(NamedTuple):
    """What the player reads: a description for JSON, the arrays in one compressed block, and sentences about omissions."""

    description: dict[str, Any]
    block: bytes
    omitted: tuple[str, ...]


def scene(
    skeleton: Skeleton,
    alignments: Mapping[int, Alignment],
    inputs: Mapping[int, CoarseMesh],
    leaves: Leaves,
    intervals: Intervals,
    limits: Limits,
    up: int = 1,
    axes: Floats | None = None,
    trust: Trust | None = None,
    assumed: Sequence[tuple[str, int, tuple[float, float, float]]] = (),
    colours: NDArray[np.uint8] | None = None,
) -> Scene:
    """The moving body, reduced to what a page can hold.

    Coordinates are rotated so that x points to the right, y up and z towards the viewer.

    alignments : by source frame number
    inputs     : by source frame number, the input meshes of the frames that play
    up         : axis that points up, see `view`
    axes       : directions of the view, as `view` gives them; None for those of these meshes
    trust      : makes the skinned mesh, its error and the confidence of joints part of the scene
    assumed    : name of each joint that was not found, the joint at the outer end of its bone, and its place in the reference
    colours    : (vertex, rgb) of the input at every vertex of the reference mesh
    """
    frames = [frame for frame in skeleton.frames if frame in inputs]
    selected_frames = np.array([skeleton.frames.index(frame) for frame in frames])
    played = [inputs[frame] for frame in frames]
    axes = directions(np.mean([m.extent for m in played], axis=0), up) if axes is None else axes
    selected, faces = decimated(np.array(skeleton.vertices), skeleton.faces, limits.vertices)
    positions = np.stack([alignments[frame].vertices[selected] @ axes for frame in frames])
    vertices = np.concatenate([m.vertices for m in played]) @ axes
    low, high = _corners(positions.reshape(-1, 3), vertices)
    lattice = Lattice.around(low, high)
    arrays: dict[str, NDArray[Any]] = {
        "positions": lattice.levels(positions),
        "faces": faces.astype(np.uint32),
        "label": skeleton.label[selected].astype(np.int16),
        "joints": (skeleton.positions[selected_frames] @ axes).astype(np.float32),
        "input_vertices": lattice.levels(vertices),
        **_input(skeleton, played),
    }
    if len(leaves.positions):
        arrays["leaves"] = (np.stack([leaves.at(frame) for frame in frames]) @ axes).astype(np.float32)
    if assumed:
        bones, places = [skeleton.parents[child] for _, child, _ in assumed], np.array([place for _, _, place in assumed])
        arrays["assumed"] = (carried(skeleton, bones, places)[selected_frames] @ axes).astype(np.float32)
    if trust is not None:
        arrays |= _rig(skeleton, selected, selected_frames, axes) | _trusted(skeleton, selected, selected_frames, trust)
    if colours is not None:
        arrays["colours"] = colours[selected]
        arrays["input_colours"] = np.concatenate([_carried(colours, skeleton, m) for m in played])
    layout, block = packed(arrays)
    description = {
        **_tree(skeleton, skeleton.names if trust is None else trust.labels),
        "most": 0.0 if trust is None else trust.share,
        "frames": frames,
        "rate": (skeleton.fps or 25.0) * len(frames) / len(skeleton.frames),
        "reach": float(np.linalg.norm(high - low)),
        "size": float(np.median(np.linalg.norm(np.ptp(positions, axis=1), axis=1))),
        "centre": positions.mean(axis=(0, 1)).tolist(),
        "low": lattice.low.tolist(),
        "scale": lattice.scale,
        "intervals": _starts(intervals, frames),
        "assumed": [{"label": label, "child": child} for label, child, _ in assumed],
        "arrays": layout,
    }
    return Scene(description, block, _omitted(skeleton, played, len(selected), limits))


def _corners(*points: Floats) -> tuple[Floats, Floats]:
    """The lowest and the highest corner of the box around all points."""
    return np.min([p.min(axis=0) for p in points], axis=0), np.max([p.max(axis=0) for p in points], axis=0)


def _input(skeleton: Skeleton, played: Sequence[CoarseMesh]) -> dict[str, NDArray[Any]]:
    """Faces and parts of the input meshes, one after the other, and where each begins."""
    return {
        "input_faces": np.concatenate([m.faces for m in played if len(m.faces)]).astype(np.uint32),
        "input_label": np.concatenate([_label(skeleton, m) for m in played]).astype(np.int16),
        "input_vertex_offsets": _offsets([len(m.vertices) for m in played]),
        "input_face_spans": _spans([len(m.faces) for m in played]),
    }


def _rig(skeleton: Skeleton, selected: Ints, frames: Ints, axes: Floats) -> dict[str, NDArray[Any]]:
    """The skinned mesh as the player poses it: selected vertices with their weights, and the rotations of all joints."""
    turns = axes.T @ np.asarray(skeleton.rotation)[frames] @ axes
    shape = turns.shape[:2]
    return {
        "rest_vertices": (np.asarray(skeleton.vertices)[selected] @ axes).astype(np.float32),
        "rest": (np.asarray(skeleton.rest) @ axes).astype(np.float32),
        "influence": np.asarray(skeleton.influence)[selected].astype(np.uint16),
        "weight": np.asarray(skeleton.weight)[selected].astype(np.float32),
        "turns": Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_quat().reshape(*shape, 4).astype(np.float32),
    }


def _trusted(skeleton: Skeleton, selected: Ints, frames: Ints, trust: Trust) -> dict[str, NDArray[Any]]:
    """Error, confidence and state as bytes; bounds where errors are known, 0 for joints without one."""
    error = np.stack([trust.error[skeleton.frames[t]][selected] for t in frames]) / max(trust.most, 1e-300)
    bound = {} if trust.bound is None else {"bound": np.nan_to_num(trust.bound[frames], nan=0.0).astype(np.float32)}
    return {
        "error": np.rint(255 * np.clip(error, 0.0, 1.0)).astype(np.uint8),
        "confidence": np.rint(255 * np.clip(np.asarray(skeleton.confidence)[frames], 0.0, 1.0)).astype(np.uint8),
        "state": np.asarray(trust.state)[frames].astype(np.uint8),
        **bound,
    }


def _tree(skeleton: Skeleton, labels: tuple[str, ...]) -> dict[str, Any]:
    """What stays the same in all frames: joints, the colours of parts and of kinds of joints, unit and frame rate."""
    return {
        "fps": skeleton.fps,
        "unit": skeleton.unit,
        "palette": part_palette(skeleton.label, skeleton.faces) or [PARTS[0]],
        "kinds": KINDS,
        "surface_leaf": SURFACE_LEAF,
        "not_rigid": NOT_RIGID,
        "joints": [
            {"name": name, "label": label, "parent": parent, "kind": kind}
            for name, label, parent, kind in zip(skeleton.names, labels, skeleton.parents, skeleton.kinds, strict=True)
        ],
    }


def _label(skeleton: Skeleton, mesh: CoarseMesh) -> Ints:
    """(vertex,) part of every vertex of a coarse mesh, −1 for none."""
    known = mesh.reference_face >= 0
    label = np.full(len(known), -1, np.int64)
    label[known] = skeleton.label[skeleton.faces[mesh.reference_face[known], mesh.reference_corner[known]]]
    return label


def _carried(colours: NDArray[np.uint8], skeleton: Skeleton, mesh: CoarseMesh) -> NDArray[np.uint8]:
    """(vertex, rgb) colour of the point of the reference mesh that every vertex of a coarse mesh belongs to; grey for none."""
    known = mesh.reference_face >= 0
    out = np.full((len(known), 3), 128, np.uint8)
    out[known] = colours[skeleton.faces[mesh.reference_face[known], mesh.reference_corner[known]]]
    return out


def packed(arrays: Mapping[str, NDArray[Any]]) -> tuple[dict[str, dict[str, Any]], bytes]:
    """The arrays in one block, which is deflated.

    returns : dtype, shape and offset of each array by name, offsets being multiples of 4 bytes; and the block
    """
    layout: dict[str, dict[str, Any]] = {}
    chunks: list[bytes] = []
    offset = 0
    for name, array in arrays.items():
        raw = np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<")).tobytes()
        layout[name] = {"dtype": str(array.dtype), "shape": list(array.shape), "offset": offset}
        raw += bytes(-len(raw) % 4)
        chunks.append(raw)
        offset += len(raw)
    return layout, zlib.compress(b"".join(chunks), _LEVEL)


def _offsets(counts: list[int]) -> NDArray[np.uint32]:
    """(frame + 1,) where the elements of each frame begin, and where the last ones end."""
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.uint32)


def _spans(counts: list[int]) -> NDArray[np.uint32]:
    """(frame, 2) where the faces of each frame begin and end; a frame without own faces has those of the one before."""
    spans = [(0, 0)]
    for count in counts:
        spans.append((spans[-1][1], spans[-1][1] + count) if count else spans[-1])
    return np.array(spans[1:], np.uint32)


def _starts(intervals: Intervals, frames: list[int]) -> list[dict[str, int]]:
    """First and last frame of each interval, and the position of the first among the frames that are shown."""
    starts = []
    for row in zip(intervals.begin, intervals.end, strict=True):
        begin, end = (intervals.frames[int(t)] for t in row)
        at = int(np.searchsorted(frames, begin))
        starts.append({"at": min(at, len(frames) - 1), "begin": begin, "end": end})
    return starts


def _omitted(skeleton: Skeleton, inputs: list[CoarseMesh], vertices: int, limits: Limits) -> tuple[str, ...]:
    """What the page does not show, in words."""
    omitted = []
    if len(inputs) < len(skeleton.frames):
        omitted.append(f"the player shows {len(inputs)} of {len(skeleton.frames)} frames")
    if vertices < len(skeleton.vertices):
        omitted.append(f"the aligned mesh is shown with {vertices} of its {len(skeleton.vertices)} vertices")
    largest = max(m.size for m in inputs)
    if largest > limits.input_vertices:
        omitted.append(f"input meshes are shown with about {limits.input_vertices} of up to {largest} vertices")
    return tuple(omitted)
