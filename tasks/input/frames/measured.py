"""What the surface of every frame measures; remembered with the digests of files."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from kinetree.errors import MeshError, SourceError
from kinetree.pipeline.identity.key import file_digest
from kinetree.pipeline.storage.files import Files
from kinetree.schemas.input.source import Source
from kinetree.tasks.input.frames.read import packed_frames
from kinetree.tasks.numerics.input.animated import Animated
from kinetree.tasks.numerics.input.bad_frames import (
    FrameMeasures,
    frame_measures,
)
from kinetree.tasks.numerics.input.formats import read_mesh
from kinetree.tasks.numerics.input.source import (
    refuse_unreadable,
)

REMOTE = "content and measures/2"
"""How the memory of files calls what is read of a mesh in a bucket."""


def measures_of_frames(sources: Mapping[int, Source], files: Files) -> dict[int, FrameMeasures | str]:
    """What the surface of every frame is like, or why it cannot be read; nothing where frames are no meshes yet."""
    kinds = {s.kind for s in sources.values()}
    if kinds <= {"npz", "zarr", "animated"}:
        first = next(iter(sources.values()))
        texts = files.parts(first.path, memory(first, "measures/2"), lambda where: _measures_of_parts(where, first))
        return {t: _parsed(texts[s.part or 0]) for t, s in sources.items()}
    if kinds == {"file"}:
        return {t: _parsed(_measures(s.path, files)) for t, s in sources.items()}
    return {}


def _measures(path: str, files: Files) -> str:
    """The measures of one mesh file, or why it cannot be read, as JSON."""
    if files.is_remote(path):
        return files.parts(path, REMOTE, content_and_measures)[1]
    return files.parts(Path(path), "measures/2", _measures_of_file)[0]


def content_and_measures(path: Path) -> Sequence[str]:
    """Digest and measures of a copy of a mesh file, which is made once for both."""
    return [file_digest(path), *_measures_of_file(path)]


def _measures_of_file(path: Path) -> Sequence[str]:
    """The measures of a mesh file as JSON, or why it cannot be read."""
    try:
        refuse_unreadable(path)
        return [json.dumps(frame_measures(*read_mesh(path)))]
    except (MeshError, SourceError) as error:
        return [json.dumps(str(error).replace(f"{path.parent}{os.sep}", ""))]


def _measures_of_parts(path: Path, of: Source) -> Sequence[str]:
    """The measures of all frames of one file, or why one cannot be read, as JSON."""
    frames = packed_frames(path, of.kind, of.clip)
    return [json.dumps(_measures_of_part(frames, t, path)) for t in range(len(frames))]


def _measures_of_part(frames: Animated, t: int, path: Path) -> object:
    try:
        return frame_measures(*frames.mesh(t))
    except (MeshError, SourceError) as error:
        return str(error).replace(f"{path.parent}{os.sep}", "")


def memory(of: Source, what: str) -> str:
    """How the memory of files calls what is read of all frames of one file."""
    return f"{of.kind}{f'={of.clip}' if of.clip else ''}/{what}"


def _parsed(text: str) -> FrameMeasures | str:
    """Measures, or the reason why there are none, from JSON."""
    measures = json.loads(text)
    if isinstance(measures, str):
        return measures
    area, size, (x, y, z), vertices, pieces, volume = measures
    return FrameMeasures(area, size, (x, y, z), vertices, pieces, volume)
