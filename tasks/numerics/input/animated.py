"""One file that holds a moving surface: an animated GLB, a USD stage, a zip of frames."""

from functools import lru_cache
from pathlib import Path
from typing import Protocol

from kinetree.errors import MeshError, SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.animated_glb import AnimatedGlb
from kinetree.tasks.numerics.input.animated_usd import AnimatedUsd
from kinetree.tasks.numerics.input.formats import MOST_BYTES
from kinetree.tasks.numerics.input.zipped import Zipped

SUFFIXES = (".glb", ".usd", ".usda", ".usdc", ".usdz", ".zip")


class Animated(Protocol):
    """A sequence of meshes whose frames are numbered from 0."""

    @property
    def fps(self) -> float | None:
        """Frames a second; None where the file does not say."""

    @property
    def unit(self) -> str | None:
        """Unit of length; None where the file does not say."""

    def __len__(self) -> int: ...

    def mesh(self, t: int) -> tuple[Floats, Faces]:
        """V (vertex, xyz) and F (face, corner) of frame t."""


def read_animated(path: Path, clip: str = "", *, is_segment: bool = False) -> Animated:
    """The frames of one file; asked again for the same unchanged file, the same value without reading.

    clip       : name of the animation, where the file has several; the first where empty
    is_segment : each morph target of the GLB is a frame
    raises     : SourceError where it cannot be read, or holds no motion
    """
    try:
        state = path.stat()
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror}") from None
    return _read(path, state.st_size, state.st_mtime_ns, clip, is_segment)


@lru_cache(maxsize=2)
def _read(path: Path, size: int, mtime_ns: int, clip: str, is_segment: bool) -> Animated:
    suffix = path.suffix.lower()
    if clip and suffix != ".glb":
        raise SourceError(f"source.clip {clip}: only a GLB has clips; leave it out for {path.name}")
    if suffix == ".zip":
        return Zipped(path)
    if suffix == ".glb":
        try:
            return AnimatedGlb(_glb_bytes(path), str(path), clip, targets_are_frames=is_segment)
        except (SourceError, MeshError) as error:
            message = str(error)
            raise SourceError(message if message.startswith(str(path)) else f"{path}: {message}") from None
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
            raise SourceError(f"{path}: cannot be read as GLB ({reason}); the file is damaged or cut short") from error
    return AnimatedUsd(path)


def _glb_bytes(path: Path) -> bytes:
    """What a GLB says that it is long; the first bytes alone where it is none."""
    with path.open("rb") as file:
        head = file.read(12)
        length = int.from_bytes(head[8:12], "little") if head[:4] == b"glTF" else 0
        if length > MOST_BYTES:
            raise SourceError(f"{length} bytes; more than {MOST_BYTES} are not read; export fewer frames")
        return head + file.read(max(length - len(head), 0))
