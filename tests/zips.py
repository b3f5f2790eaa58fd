"""Alters one file inside a stored artifact, with every checksum of the zip around it as it should be."""

import zipfile
from collections.abc import Callable
from pathlib import Path

from kinetree.pipeline.storage.packed import packed


def alter(path: Path, name: str, change: Callable[[bytes], bytes | None]) -> None:
    """Changes the file of that name in the zip at `path`; None removes it."""
    with zipfile.ZipFile(path) as archive:
        files = {file: archive.read(file) for file in archive.namelist()}
    changed = {file: change(data) if file == name else data for file, data in files.items()}
    path.write_bytes(packed({file: data for file, data in changed.items() if data is not None}))
