"""The true skeleton of a sequence, where somebody knows it."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params, PathLike
from kinetree.schemas.dims import FRAME, JOINT, VERTEX, XYZ


class TruthParams(Params):
    """Where the truth is; a synthetic sequence brings its own."""

    file: Annotated[str, PathLike()] = ""
    """A truth.json as kinetree synth writes it, the skeleton.json of another run, or a BVH; nothing: no evaluation."""
    body: Annotated[str, PathLike()] = ""
    """An npz of the true body, whose skinning weights say which part each point of the surface belongs to."""
    unit: str | None = None
    """Unit of the truth's coordinates where its file does not say, e.g. cm; None takes the sequence's."""


class Truth(Artifact):
    """The true joints in every frame; without joints where no truth is given."""

    source: str
    """Name of the file, as messages call it; empty where there is none."""
    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    fps: float | None
    """Frames a second; None where nobody knows."""
    unit: str | None
    """Unit of all lengths; None where nobody knows."""
    height: float | None
    """What errors are a share of, length; None where nobody says."""
    names: tuple[str, ...]
    """Name of every joint."""
    parents: tuple[int, ...]
    """Parent of every joint, −1 for the root."""
    kinds: tuple[Literal["joint", "tip"], ...]
    """joint: may turn; tip: the end of a bone."""
    scored: tuple[bool, ...]
    """Whether each joint turns enough to be asked for."""
    turns: Annotated[Floats, Array("float64", JOINT, unit="°", finite=False)]
    """How far each joint turns against its parent over the clip; NaN where nobody says."""
    positions: Annotated[Floats, Array("float64", FRAME, JOINT, XYZ, unit="length")]
    """Of every joint in every frame."""
    vertices: Annotated[NDArray[np.float32], Array("float32", FRAME, VERTEX, XYZ, unit="length")]
    """The true body in every frame; no vertices where it is not known."""
    carrier: Annotated[Ints, Array("int32", VERTEX)]
    """The joint that each vertex of the true body follows most."""
    bone_end: Annotated[Ints, Array("int32", VERTEX)]
    """The other end of the one bone that the vertex follows; −1 where the joint carries all its bones as one."""
