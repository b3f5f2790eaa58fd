"""A zip of mesh files, one a frame, as a sequence; nothing is written to disk, and sizes are held against bounds first."""

import zipfile
from pathlib import Path, PurePosixPath

from kinetree.errors import SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.formats import MOST_BYTES, mesh_of
from kinetree.tasks.numerics.input.source import one_format
from kinetree.tasks.numerics.input.unpacked import bomb


class Zipped:
    """The frames of a zip in the natural order of their names.

    names : of its members that are frames
    """

    fps: float | None = None
    unit: str | None = None

    def __init__(self, path: Path) -> None:
        """Reads the list of members; raises SourceError where it is no zip, or no mesh is in it."""
        self.name = str(path)
        self._path = path
        try:
            with zipfile.ZipFile(path) as archive:
                there = [info for info in archive.infolist() if not info.is_dir()]
        except Exception as error:  # of many kinds, some of them undocumented
            reason = f"{type(error).__name__}: {error}"
            raise SourceError(f"{path}: cannot be read as a zip ({reason}); it is damaged or something else") from error
        if out := next((info.filename for info in there if ".." in PurePosixPath(info.filename).parts), ""):
            raise SourceError(
                f"{path}: the name {out!r} leads out of the zip; nothing of it is read, zip the folder itself again"
            )
        members = {PurePosixPath(i.filename): i for i in there if not _is_hidden(PurePosixPath(i.filename))}
        self.names = one_format(list(members), self.name)
        self._members = [members[name] for name in self.names]
        for info in self._members:
            if info.flag_bits & 1:
                raise SourceError(f"{path}: {info.filename} is encrypted; zip it without a password")
            if info.file_size > MOST_BYTES:
                raise SourceError(f"{path}: {info.filename}: {info.file_size} bytes; more than {MOST_BYTES} are no frame")
            if why := bomb(info.compress_size, info.file_size):
                raise SourceError(f"{path}: {info.filename}: {why}")

    def __len__(self) -> int:
        return len(self._members)

    def mesh(self, t: int) -> tuple[Floats, Faces]:
        """V (vertex, xyz) and F (face, corner) of frame t; SourceError where there is none, MeshError as `mesh_of`."""
        if not 0 <= t < len(self):
            raise SourceError(f"{self.name}: there is no frame {t}; frames are 0 to {len(self) - 1}")
        info = self._members[t]
        try:
            with zipfile.ZipFile(self._path) as archive, archive.open(info) as file:
                raw = file.read(info.file_size + 1)
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
            raise SourceError(f"{self.name}: {info.filename} cannot be unpacked ({reason}); the archive is damaged") from error
        return mesh_of(raw, f"{self.name}, {info.filename}", self.names[t].suffix)


def _is_hidden(path: PurePosixPath) -> bool:
    return any(part.startswith(".") or part == "__MACOSX" for part in path.parts)
