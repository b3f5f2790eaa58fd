"""Runs of frames whose graphs have the body's topology (2009, Sec. 2.2)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints, Params
from kinetree.schemas.dims import FRAME, INTERVAL


class CoherentIntervalsParams(Params):
    """What the graph of a coherent frame has."""

    ends: int | None = Field(default=None, ge=0)
    """Ends of the graph, condition (i); null takes the number that prevails in the sequence."""
    branches: tuple[tuple[int, ...], ...] | None = None
    """Numbers of edges at its branch points, condition (ii), e.g. [[4, 3], [3, 3, 3]]; null takes those that prevail."""
    minimum: int = Field(default=3, ge=1)
    """Frames of a coherent interval."""


class CoherentIntervals(Artifact):
    """Which frames are coherent, and why the others are not."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    coherent: Annotated[Bools, Array("bool", FRAME)]
    """Whether a frame fulfils both conditions and has no loop."""
    ends: Annotated[Ints, Array("int32", FRAME)]
    """Ends of each frame's graph."""
    loops: Annotated[Ints, Array("int32", FRAME)]
    """Loops of each frame's graph after simplification."""
    reach: Annotated[Floats, Array("float64", FRAME)]
    """Share of the range of μ that the longest of them spans; 0 without one."""
    spread: Annotated[Floats, Array("float64", FRAME)]
    """Mean distance between the ends of each frame's graph, share of the root of the body's area."""
    length: Annotated[Floats, Array("float64", FRAME)]
    """Geometric mean of the lengths of each graph's branches, share of the root of the body's area."""
    degrees: tuple[tuple[int, ...], ...]
    """Branch degrees of each frame's graph."""
    begin: Annotated[Ints, Array("int32", INTERVAL)]
    """Position of the first frame of each coherent interval."""
    end: Annotated[Ints, Array("int32", INTERVAL)]
    """Position of its last frame, included."""
    wanted_ends: int
    """Ends that a coherent graph has."""
    wanted_branches: tuple[tuple[int, ...], ...]
    """Branch degrees that it may have."""
