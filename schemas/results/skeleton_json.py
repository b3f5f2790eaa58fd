"""The skeleton as a JSON file, and the model of that file."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from kinetree.schemas.results.exports import Exported

FORMAT = "kinetree.skeleton/1"
Point = tuple[float, float, float]
Share = Annotated[float, Field(ge=0, le=1)]


class _FileObject(BaseModel):
    """An object of the file: it has the listed keys and no others."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)


class Joint(_FileObject):
    """One joint of the tree."""

    name: str
    """Readable, unique and the same on every run."""
    parent: Annotated[int, Field(ge=0)] | None
    """Position of its parent in the list of joints, before its own; null for the root."""
    kind: Literal["root", "joint", "leaf"]
    """root: no parent; joint: turns against its parent; leaf: the end of a bone, turns with its parent."""


class Bone(_FileObject):
    """One bone, from a joint to its parent."""

    parent: Annotated[int, Field(ge=0)]
    """Position of the parent in the list of joints."""
    child: Annotated[int, Field(ge=0)]
    """Position of the child in the list of joints."""
    length: Annotated[float, Field(ge=0)]
    """Length in the file's unit, the same in every frame."""


class Document(_FileObject):
    """What skeleton.json holds: the joint tree and every joint's position in every frame."""

    format: Literal["kinetree.skeleton/1"]
    """Name and version of this format."""
    unit: str | None
    """Unit of all lengths; null where it is not known."""
    fps: Annotated[float, Field(gt=0)] | None
    """Frames a second; null where it is not known."""
    frames: list[Annotated[int, Field(ge=0)]]
    """Source frame number of every frame, ascending."""
    joints: list[Joint]
    """The joints, parents before their children."""
    positions: list[list[Point]]
    """Position of every joint in every frame, [frame][joint][xyz], in the coordinates of the input."""
    bones: list[Bone]
    """The bones, one for every joint but the root."""
    confidence: list[list[Share]]
    """Confidence of every joint's position in every frame, 0 to 1, [frame][joint]."""


class SkeletonJson(Exported):
    """skeleton.json: see `Document`."""
