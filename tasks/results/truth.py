"""The true skeleton of a sequence, read from the user's file before anything is computed."""

import re
import zipfile
import zlib
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import InputError
from kinetree.pipeline.task import origin
from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.truth import Truth, TruthParams
from kinetree.tasks.input.synth import body
from kinetree.tasks.numerics.results.evaluation.body import nearest
from kinetree.tasks.numerics.results.evaluation.truth import TrueMotion, factor, of_told, read_truth

SYNTH = "synth"
"""What the truth of a generated sequence is called."""


@origin()
def truth(params: TruthParams, files: object) -> Truth:
    """Reads the true joints that the result is to be compared with, where there are any (2014, Sec. 7.1)."""
    if not params.file:
        if params.body:
            raise InputError(f"truth.body ({params.body}) says nothing without truth.file; name the file of the joints")
        return _told(None, "", None)
    return _read(params, _stamp(params.file), _stamp(params.body))


def synthetic(recipe: str) -> Truth:
    """The truth of a generated sequence, from the recipe its frames are made by."""
    return _told(of_told(body(recipe).truth(), SYNTH), SYNTH, None)


def true_carriers(truth: Truth, source: Source, V: Floats, frame: int, unit: str | None) -> tuple[Ints, Ints] | None:
    """(vertex,) the true joint that carries the surface at each of the vertices V, and the end of its bone, or −1 for all.

    V, unit : (vertex, xyz) vertices of a frame in the sequence's unit, and that unit
    returns : None where nobody knows
    """
    if source.recipe and truth.source == SYNTH:
        made = body(source.recipe)
        told = made.truth()
        first = np.array([truth.names.index(joints[0]) for joints in told["parts"]], dtype=np.int32)
        carrier = first[made.parts(source.part or 0, V)]
        return carrier, np.full_like(carrier, -1)
    if not truth.vertices.shape[1]:
        return None
    scale = factor(truth.unit, unit, truth.source)
    at = nearest(truth.vertices[truth.frames.index(frame)] * scale, V)
    return truth.carrier[at], truth.bone_end[at]


def _stamp(path: str) -> tuple[int, int]:
    """Size and time of a file, so that what was read of it is remembered until it changes."""
    try:
        stat = Path(path).stat() if path else None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    return (stat.st_size, stat.st_mtime_ns) if stat else (0, 0)


@lru_cache(maxsize=2)
def _read(params: TruthParams, *stamps: tuple[int, int]) -> Truth:
    path = Path(params.file)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file; a truth is a truth.json, a skeleton.json or a .bvh file") from None
    return _told(read_truth(text, path.name), path.name, params)


def _told(motion: TrueMotion | None, source: str, params: TruthParams | None) -> Truth:
    """The artifact; without joints where there is no motion."""
    if motion is None:
        motion = TrueMotion((), (), (), (), (), (), np.zeros((0, 0, 3)), None, None, None)
    vertices: NDArray[np.float32] = np.zeros((len(motion.X), 0, 3), np.float32)
    carrier, end = np.zeros(0, np.int32), np.zeros(0, np.int32)
    if params is not None and params.body:
        vertices, carrier, end = _body(Path(params.body), motion)
    return Truth(
        source=source,
        frames=motion.frames,
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
        with np.load(path, allow_pickle=False) as held:
            V, W = (np.array(held[key], dtype=np.float64) for key in ("vertices", "weights"))
            told = [str(n) for n in np.atleast_1d(held["weight_names"])]
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(
            f"{path}: not a body: {error}; expected an npz with vertices, weights and weight_names, one connectivity"
        ) from None
    follows = [_followed(name, motion) for name in told]
    unknown = [name for name, joint in zip(told, follows, strict=True) if joint is None]
    if unknown or W.ndim != 2 or W.shape[1] != len(told):
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
    """What a column of weights follows: a joint by its name, or one bone by the numbers of both joints, as bone_3_4."""
    if name in motion.names:
        return motion.names.index(name), -1
    bone = re.fullmatch(r"bone_(\d+)_(\d+)", name)
    if bone and int(bone[2]) < len(motion.names) and motion.parents[int(bone[2])] == int(bone[1]):
        return int(bone[1]), int(bone[2])
    return None
