"""What the surface of one frame looks like, read from its file and what lies beside it."""

import zipfile
from pathlib import Path

from kinetree.schemas.input.source import Source
from kinetree.tasks.input.frames.read import surface
from kinetree.tasks.numerics.input.gltf_appearance import SurfaceAppearance
from kinetree.tasks.numerics.input.pictures import MOST_BYTES
from kinetree.tasks.numerics.input.surface_appearance import names_appearance, surface_appearance
from kinetree.tasks.numerics.input.zipped import Zipped


def has_own_file(frame: Source) -> bool:
    """Whether the frame is of a file here that may have an appearance; what lies in a bucket is not brought for it."""
    return frame.kind in ("file", "animated") and "://" not in frame.path


def appearance_of(frame: Source, *, quickly: bool = False) -> SurfaceAppearance | None:
    """What the file of a frame looks like; None where it has no appearance, or its format's is not read.

    quickly : whether a file whose first bytes promise none is not read to its end
    """
    path = Path(frame.path)
    if path.suffix.lower() != ".zip":
        is_one = frame.kind == "animated"
        raw = path.read_bytes()
        if quickly and not names_appearance(raw, path.suffix):
            return None
        return surface_appearance(raw, path.suffix, surface(frame)[1], lambda named: _beside(path.parent, named), is_one)
    member = Zipped(path).names[frame.part or 0]
    with zipfile.ZipFile(path) as archive:
        raw = archive.read(str(member))
        if quickly and not names_appearance(raw, member.suffix):
            return None
        return surface_appearance(
            raw, member.suffix, surface(frame)[1], lambda named: _packed(archive, str(member.parent / named))
        )


def _packed(archive: zipfile.ZipFile, named: str) -> bytes | None:
    """The bytes of a member of a zip; None where there is none, or it is too large."""
    info = archive.NameToInfo.get(named)
    return archive.read(info) if info is not None and info.file_size <= MOST_BYTES else None


def _beside(folder: Path, named: str) -> bytes | None:
    """The bytes of a file in a folder or below it; None where there is none, it is too large or it leads out of the folder."""
    path = (folder / named.replace("\\", "/")).resolve()
    if not path.is_relative_to(folder.resolve()) or not path.is_file() or path.stat().st_size > MOST_BYTES:
        return None
    return path.read_bytes()
