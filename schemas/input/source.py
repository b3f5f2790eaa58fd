"""Where the frames of a sequence lie and what they hold; nothing of their geometry yet."""

from typing import Annotated, Literal

from kinetree.schemas.array import Artifact, Location, Params, PathLike
from kinetree.schemas.input.synth import SynthParams


class SourceParams(Params):
    """Where the sequence is and which of its frames are wanted."""

    input: Annotated[str, PathLike()] = ""
    """A folder or glob of mesh files, one a frame, or one .npz or zarr file that holds all frames."""
    synth: SynthParams | None = None
    """A synthetic sequence to generate instead of reading one; excludes `input`."""
    frames: str = ":"
    """The frames wanted, as start:stop:step over the sequence's own numbering, e.g. 10:60:2."""


class Source(Artifact):
    """One frame as the user gave it: which bytes, where they lie, and what the file says about time and unit."""

    content: str
    """Digest of the bytes that make this frame; equal for equal content, whatever the file's name or age."""
    path: Annotated[str, Location()]
    """The file, or the folder of a zarr group."""
    part: Annotated[int | None, Location()] = None
    """Position in a file that holds all frames, or in a synthetic sequence; None for one file a frame."""
    recipe: Annotated[str, Location()] = ""
    """What a synthetic frame is made by, as JSON; its digest is in `content`."""
    kind: Literal["file", "npz", "zarr", "synth"] = "file"
    """How to read it."""
    fps: float | None = None
    """Frames a second as the file states it; None where it does not."""
    unit: str | None = None
    """Unit of length as the file states it; None where it does not."""
