"""The moving body as the page's player reads it: a description in JSON and one block of compressed arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

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
from kinetree.tasks.results.page.packing import Packing
from kinetree.tasks.results.plots.drawing import directions


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


class Scene(NamedTuple):
    """What the player reads: a description for JSON, the arrays in one compressed block, and sentences about omissions.

    reference_vertex : (vertex,) the vertices of the reference mesh that play
    axes             : (xyz, xyz) the view's axes as columns
    """

    description: dict[str, Any]
    packing: Packing
    omitted: tuple[str, ...]
    reference_vertex: Ints
    axes: Floats

    @property
    def block(self) -> bytes:
        """The arrays as the page contains them."""
        return self.packing.ended()


def scene(
    skeleton: Skeleton,
    alignments: Mapping[int, Alignment],
    inputs: Mapping[int, CoarseMesh],
    leaves: Leaves,
    intervals: Intervals,
    limits: Limits,
    up: int = 1,
    axes: Floats | None = None,
    assumed: Sequence[tuple[str, int, tuple[float, float, float]]] = (),
    colours: NDArray[np.uint8] | None = None,
) -> Scene:
    """The moving body, reduced to what a page can hold.

    Coordinates are rotated so that x points to the right, y up and z towards the viewer.

    alignments : by source frame number
    inputs     : by source frame number, the input meshes of the frames that play
    up         : axis that points up, see `view`
    axes       : directions of the view, as `view` gives them; None for those of these meshes
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
    if colours is not None:
        arrays["colours"] = colours[selected]
        arrays["input_colours"] = np.concatenate([_carried(colours, skeleton, m) for m in played])
    packing = Packing({}).followed_by(arrays)
    description = {
        **_tree(skeleton),
        "most": 0.0,
        "frames": frames,
        "rate": (skeleton.fps or 25.0) * len(frames) / len(skeleton.frames),
        "reach": float(np.linalg.norm(high - low)),
        "size": float(np.median(np.linalg.norm(np.ptp(positions, axis=1), axis=1))),
        "centre": positions.mean(axis=(0, 1)).tolist(),
        "low": lattice.low.tolist(),
        "scale": lattice.scale,
        "intervals": _starts(intervals, frames),
        "assumed": [{"label": label, "child": child} for label, child, _ in assumed],
        "arrays": packing.layout,
    }
    return Scene(description, packing, _omitted(skeleton, played, len(selected), limits), selected, axes)


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


def _tree(skeleton: Skeleton) -> dict[str, Any]:
    """What stays the same in all frames: joints, the colours of parts and of kinds of joints, unit and frame rate."""
    return {
        "fps": skeleton.fps,
        "unit": skeleton.unit,
        "palette": part_palette(skeleton.label, skeleton.faces) or [PARTS[0]],
        "kinds": KINDS,
        "surface_leaf": SURFACE_LEAF,
        "not_rigid": NOT_RIGID,
        "joints": [
            {"name": name, "label": name, "parent": parent, "kind": kind}
            for name, parent, kind in zip(skeleton.names, skeleton.parents, skeleton.kinds, strict=True)
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
