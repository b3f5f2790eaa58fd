"""The true skeleton of a sequence, where it is known."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Ints, Params, PathLike
from kinetree.schemas.dims import FRAME, JOINT, VERTEX, XYZ
from kinetree.schemas.input.sequence import Unit


class TruthParams(Params):
    """The files of the truth; a generated sequence has its own."""

    file: Annotated[str, PathLike()] = ""
    """A truth.json as kinetree synth writes it, the skeleton.json of another run, or a BVH; empty: no evaluation."""
    body: Annotated[str, PathLike()] = ""
    """An npz of the true body with skinning weights, from which the true part of every vertex is known; empty: none."""
    first: int | None = Field(default=None, ge=0)
    """Number of the frame that the truth begins with, where its file does not number frames; None: the sequence's first if
    both have as many frames, else 0."""
    unit: Unit | None = None
    """Unit of the truth's coordinates where its file has none, e.g. cm; None: the sequence's unit."""


class TrueBody(Artifact):
    """The true joints in every frame; without joints where no truth is given."""

    source: str
    """Name of the file, for messages; synth for a generated sequence; empty where there is no truth."""
    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    numbered: bool = False
    """Whether the numbers are stated; else they are 0, 1, 2, … until they are held against the sequence."""
    fps: float | None
    """Frames a second; None where not known."""
    unit: str | None
    """Unit of all lengths; None where not known."""
    height: float | None
    """Height of the body, of which errors are shares, length; None where not known."""
    names: tuple[str, ...]
    """Name of every joint."""
    parents: tuple[int, ...]
    """Parent of every joint, −1 for the root."""
    kinds: tuple[Literal["joint", "tip"], ...]
    """joint: may turn; tip: the end of a bone."""
    scored: tuple[bool, ...]
    """Whether a result should have each joint, because it turns enough."""
    turns: Annotated[Floats, Array("float64", JOINT, unit="°", finite=False)]
    """Range of each joint's angle against its parent over the clip; NaN where not known."""
    positions: Annotated[Floats, Array("float64", FRAME, JOINT, XYZ, unit="length")]
    """Position of every joint in every frame."""
    vertices: Annotated[NDArray[np.float32], Array("float32", FRAME, VERTEX, XYZ, unit="length")]
    """The true body in every frame; no vertices where it is not known."""
    carrier: Annotated[Ints, Array("int32", VERTEX)]
    """The joint that each vertex of the true body follows most."""
    bone_end: Annotated[Ints, Array("int32", VERTEX)]
    """The other end of the one bone that the vertex follows; −1 where the joint carries all its bones as one rigid group."""


class Truth(TrueBody):
    """The truth as its file has it."""
