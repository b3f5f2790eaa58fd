"""The true skeleton of a sequence, read from the user's file before anything is computed."""

import re
import zipfile
import zlib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import InputError
from kinetree.errors.small_text import small_text
from kinetree.pipeline.task import origin
from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.truth import TrueBody, Truth, TruthParams
from kinetree.tasks.numerics.input.npz import npz_arrays
from kinetree.tasks.numerics.results.truth import TrueMotion, read_truth, truth_of_json
from kinetree.tasks.numerics.results.units import unit_factor

SYNTH = "synth"
"""The name of the truth of a generated sequence, in place of a file's."""


@origin()
def truth(params: TruthParams, files: object) -> Truth:
    """Reads the true joints with which the result is compared, where they are given (2014, Sec. 7.1)."""
    if not params.file:
        if params.body:
            raise InputError(f"truth.body ({params.body}) needs truth.file; set it to the file of the true joints")
        return _artifact(None, "", None)
    return _read(params, _stamp(params.file), _stamp(params.body))


def synthetic(recipe: str) -> Truth:
    """The truth of a generated sequence, computed from the recipe of its frames."""
    from kinetree.tasks.input.synth import body  # every plan reads a truth, and generates nothing

    return _artifact(truth_of_json(body(recipe).truth(), SYNTH), SYNTH, None)


def numbered(truth: Truth, source: Mapping[int, Source]) -> Truth:
    """The truth with the numbers of the sequence's frames; one whose file has no numbers begins with the sequence.

    raises : InputError where it may begin elsewhere: the sequence does not begin with frame 0 and has another number of frames
    """
    first, last = next((frame.series for frame in source.values()), (0, 0))
    if truth.numbered or not truth.frames or first == 0:
        return truth
    if len(truth.frames) != last - first + 1:
        raise InputError(
            f"{truth.source}: {len(truth.frames)} frames without numbers, but the sequence has frames {first} to {last};"
            " set truth.first to the number of the truth's first frame, or give the file a list `frames`"
        )
    return truth.model_copy(update={"frames": tuple(range(first, last + 1)), "numbered": True})


def true_carriers(truth: TrueBody, source: Source, V: Floats, frame: int, unit: str | None) -> tuple[Ints, Ints] | None:
    """The true joint that each vertex of a frame follows most, and the end of the one bone that it follows.

    V       : (vertex, xyz) vertices of the frame, in the sequence's unit
    frame   : source frame number
    unit    : the sequence's unit
    returns : two of (vertex,) joints, the second −1 where the joint carries all its bones; None where nothing is known
    """
    from kinetree.tasks.input.synth import body
    from kinetree.tasks.numerics.results.evaluation.body import nearest_vertices

    if source.recipe and truth.source == SYNTH:
        first_joint = np.array([truth.names.index(name) for name in _first_joints(source.recipe)], dtype=np.int32)
        carrier = first_joint[body(source.recipe).parts(source.part or 0, V)]
        return carrier, np.full_like(carrier, -1)
    if not truth.vertices.shape[1]:
        return None
    scale = unit_factor(truth.unit, unit, truth.source)
    at = nearest_vertices(truth.vertices[truth.frames.index(frame)] * scale, V)
    return truth.carrier[at], truth.bone_end[at]


@lru_cache(maxsize=2)
def _first_joints(recipe: str) -> tuple[str, ...]:
    """The first joint of every true rigid part of a generated sequence, by name."""
    from kinetree.tasks.input.synth import body

    return tuple(joints[0] for joints in body(recipe).truth()["parts"])


def _stamp(path: str) -> tuple[int, int]:
    """Size and time of change of a file, by which `_read` notices that it has changed."""
    try:
        stat = Path(path).stat() if path else None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    return (stat.st_size, stat.st_mtime_ns) if stat else (0, 0)


@lru_cache(maxsize=2)
def _read(params: TruthParams, *stamps: tuple[int, int]) -> Truth:
    """The truth in the files named by the parameters; kept in memory until a file changes."""
    path = Path(params.file)
    return _artifact(read_truth(small_text(path), path.name), path.name, params)


def _artifact(motion: TrueMotion | None, source: str, params: TruthParams | None) -> Truth:
    """The artifact of a motion; without joints where there is none."""
    if motion is None:
        motion = TrueMotion((), (), (), (), (), (), np.zeros((0, 0, 3)), None, None, None)
    first = params.first if params is not None and not motion.numbered else None
    vertices: NDArray[np.float32] = np.zeros((len(motion.X), 0, 3), np.float32)
    carrier, end = np.zeros(0, np.int32), np.zeros(0, np.int32)
    if params is not None and params.body:
        vertices, carrier, end = _body(Path(params.body), motion)
    return Truth(
        source=source,
        frames=motion.frames if first is None else tuple(range(first, first + len(motion.frames))),
        numbered=motion.numbered or first is not None,
        fps=motion.fps,
        unit=motion.unit or (params.unit if params else None),
        height=motion.height,
        names=motion.names,
        parents=motion.parents,
        kinds=motion.kinds,
        scored=motion.scored,
        turns=np.array(motion.turns, dtype=np.float64),
        positions=motion.X,
        vertices=vertices,
        carrier=carrier,
        bone_end=end,
    )


def _body(path: Path, motion: TrueMotion) -> tuple[NDArray[np.float32], Ints, Ints]:
    """(frame, vertex, xyz) the true body, (vertex,) the joint each vertex follows most, and the end of its bone or −1."""
    try:
        arrays = npz_arrays(path, ("vertices", "weights", "weight_names"), InputError)
        V, W = (np.array(arrays[key], dtype=np.float64) for key in ("vertices", "weights"))
        columns = [str(n) for n in np.atleast_1d(arrays["weight_names"])]
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(
            f"{path}: not a body: {error}; expected an npz with vertices, weights and weight_names, one set of faces"
        ) from None
    follows = [_followed(name, motion) for name in columns]
    unknown = [name for name, joint in zip(columns, follows, strict=True) if joint is None]
    if unknown or W.ndim != 2 or W.shape[1] != len(columns):
        raise InputError(f"{path}: weights must be (vertex, joint) of the truth's joints; {unknown[:3]} are none of them")
    if len(V) != len(motion.frames) * len(W):
        raise InputError(
            f"{path}: {len(V)} vertices are not {len(motion.frames)} frames of {len(W)}; the truth and the body differ"
        )
    if V.shape[1:] != (3,) or not np.isfinite(V).all() or not np.isfinite(W).all() or not W.size:
        raise InputError(f"{path}: vertices must be (frame · vertex, 3), got {V.shape}, and all numbers finite")
    joint, end = np.array([f for f in follows if f], dtype=np.int32)[W.argmax(axis=1)].T
    return V.reshape(len(motion.frames), len(W), 3).astype(np.float32), joint, end


def _followed(name: str, motion: TrueMotion) -> tuple[int, int] | None:
    """The joint of a column of weights: by its name, or with the end of one bone by both numbers, as in bone_3_4."""
    if name in motion.names:
        return motion.names.index(name), -1
    bone = re.fullmatch(r"bone_(\d+)_(\d+)", name)
    if bone and int(bone[2]) < len(motion.names) and motion.parents[int(bone[2])] == int(bone[1]):
        return int(bone[1]), int(bone[2])
    return None
