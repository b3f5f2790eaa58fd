"""The skeleton as programs take it: a JSON file and the model that it follows."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from kinetree.schemas.results.exports import Exported

FORMAT = "kinetree.skeleton/1"
Point = tuple[float, float, float]
Share = Annotated[float, Field(ge=0, le=1)]


class _Told(BaseModel):
    """What every object of the file has in common: nothing but the keys that are listed."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)


class Joint(_Told):
    """One joint of the tree."""

    name: str
    """Readable, unique and the same on every run."""
    parent: Annotated[int, Field(ge=0)] | None
    """Its parent's place in the list of joints, which lies before its own; null for the root."""
    kind: Literal["root", "joint", "leaf"]
    """root: no parent; joint: turns against its parent; leaf: the end of a bone."""


class Bone(_Told):
    """One bone, from a joint to its parent."""

    parent: Annotated[int, Field(ge=0)]
    """Place of the parent in the list of joints."""
    child: Annotated[int, Field(ge=0)]
    """Place of the child in the list of joints."""
    length: Annotated[float, Field(ge=0)]
    """The same in every frame, in the file's unit."""


class Document(_Told):
    """What skeleton.json holds: the joint tree and every joint's position in every frame."""

    format: Literal["kinetree.skeleton/1"]
    """Name and version of this format."""
    unit: str | None
    """Unit of all lengths; null where nobody knows."""
    fps: Annotated[float, Field(gt=0)] | None
    """Frames a second; null where nobody knows."""
    frames: list[Annotated[int, Field(ge=0)]]
    """Number of every frame in the source, ascending."""
    joints: list[Joint]
    """The joints, parents before their children."""
    positions: list[list[Point]]
    """Position of every joint in every frame, [frame][joint][xyz], in the coordinates of the input."""
    bones: list[Bone]
    """The bones, one for every joint but the root."""
    confidence: list[list[Share]]
    """How far a joint's position in a frame is to be believed, [frame][joint]."""


class SkeletonJson(Exported):
    """skeleton.json: see `Document`."""
