"""Files for other programs, as all exports store them: bytes with names."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator

from kinetree.errors import ArtifactError
from kinetree.schemas.array import Array, Artifact
from kinetree.schemas.dims import BYTE


def inside(name: str) -> str:
    """A path that stays in the folder it is relative to, on every system; raises ArtifactError where it may not."""
    if "\\" in name or not name.isprintable() or any(part in ("", ".", "..") for part in name.split("/")):
        raise ArtifactError(f"names: expected a path in the output folder such as tables/joints.csv, got {name!r}")
    return name


class Exported(Artifact):
    """Files of one format; each export has its own subclass and its own task."""

    names: tuple[Annotated[str, AfterValidator(inside)], ...]
    """Path of every file, relative to the output folder."""
    sizes: tuple[int, ...]
    """Bytes of every file."""
    content: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The bytes of all files, one after the other."""

    @classmethod
    def of(cls, files: Mapping[str, bytes], **more: Any) -> Self:
        """The artifact of some files by name; `more` are its other fields."""
        content = np.frombuffer(b"".join(files.values()), np.uint8)
        return cls(names=tuple(files), sizes=tuple(map(len, files.values())), content=content, **more)


class PlacedFile(Exported):
    """Files whose coordinates are those of the input, turned upright and scaled."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"]
    """Axis of the input that was taken to point up."""
    up_confidence: float
    """Confidence in it, 0 to 1; 1 where the user says it."""
    metres: float
    """Length of one unit of the input that was assumed, metres."""
    metres_from: Literal["parameter", "unit", "size"]
    """What that length is from: a parameter, the sequence's unit, or the size of the body, which is a guess."""
    unknown_unit: str | None
    """Unit that the input states, where nobody knows its length."""
    assumed_fps: float | None
    """Assumed frames a second; None where the sequence has a frame rate."""
