"""Where the frames of a sequence lie and what they hold; nothing of their geometry yet."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from kinetree.errors import ArtifactError
from kinetree.schemas.array import Artifact, Index, Location, Params, PathLike
from kinetree.schemas.input.synth import SynthParams

Kind = Literal["file", "npz", "zarr", "animated", "segment", "synth", "silhouettes", "volume"]


class TakeParams(Params):
    """One of several takes of one body."""

    name: str = Field(default="take", pattern=r"^[A-Za-z0-9_-]{1,40}$")
    """What files of this take are called by."""
    input: Annotated[str, PathLike()] = ""
    """As `source.input`, of this take alone."""
    clip: str = ""
    """As `source.clip`, of this take alone."""


class SourceParams(Params):
    """Where the sequence is and which of its frames are wanted."""

    input: Annotated[str, PathLike()] = ""
    """Folder or glob of meshes, silhouettes or volumes, or one file of all frames (npz, zarr, GLB, USD, zip); meshes also at s3://."""
    clip: str = ""
    """Name of the animation in a GLB (empty: its first), or of the target of a volumetric manifest (empty: its finest)."""
    takes: tuple[TakeParams, ...] = ()
    """Several takes of one body, which have one skeleton; excludes `input` and `synth`."""
    synth: SynthParams | None = None
    """A synthetic sequence to generate instead of reading one; excludes `input`."""
    frames: str = ":"
    """The frames wanted, as start:stop:step over the numbers of the frames, which are those in the files' names: 10:60:2."""
    on_bad_frame: Literal["drop", "fail"] = "drop"
    """Meshes that cannot be read, or stand out in size, place or pieces: drop goes on without them, fail refuses the run."""
    other_body: Literal["drop", "keep"] = "drop"
    """Frames from which on the volume says another body: drop counts them as bad frames, keep takes them for the same body."""
    bad_share: float = Field(default=0.2, ge=0, lt=1)
    """Largest share of the frames that is dropped; with more of them the run is refused."""


class BadFrame(Params):
    """A frame that is left out of the sequence."""

    frame: int
    """Its number."""
    reason: str
    """Why, in words."""


class Source(Artifact):
    """One frame as the user gave it: which bytes, where they lie, and what the file says about time and unit."""

    opens: ClassVar[tuple[str, ...]] = ("frame/silhouettes", "frame/volume")

    content: str
    """Digest of the bytes that make this frame; equal for equal content, whatever the file's name or age."""
    path: Annotated[str, Location()]
    """The file, or the folder of a zarr group or of silhouettes."""
    part: Annotated[int | None, Location()] = None
    """Position in a file that holds all frames, in a synthetic sequence or among silhouettes; None for one file a frame."""
    recipe: Annotated[str, Location()] = ""
    """What a synthetic frame is made by, as JSON; its digest is in `content`."""
    take: str = ""
    """Name of the take that it is from; empty where there is one alone."""
    clip: Annotated[str, Location()] = ""
    """Name of the animation that it is a frame of, where one of several was chosen."""
    kind: Kind = "file"
    """How to read it: the first six are meshes; segment: each morph target of a GLB is a frame."""
    calibration: Annotated[tuple[str, ...], Location()] = ()
    """The files that calibrate the cameras of silhouettes."""
    masks: Annotated[tuple[str, ...], Location()] = ()
    """The mask of every camera in the calibration's order, empty where a camera has none; one npz may hold all."""
    series: Annotated[tuple[int, int], Location()] = (0, 0)
    """First and last frame number of the whole series; a truth without frame numbers is held against them."""
    fps: float | None = None
    """Frames a second as the file states it; None where it does not."""
    unit: str | None = None
    """Unit of length as the file states it; None where it does not."""

    dropped: tuple[BadFrame, ...] = ()
    """Frames that were left out directly after this one, or before it if it is the first."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """One hull for silhouettes, one isosurface for silhouettes or a volume, none for a mesh."""
        if space not in self.opens:
            raise ArtifactError(f"Source opens no index {space!r}")
        kinds = {"frame/silhouettes": ("silhouettes",), "frame/volume": ("silhouettes", "volume")}[space]
        return (0,) if self.kind in kinds else ()
