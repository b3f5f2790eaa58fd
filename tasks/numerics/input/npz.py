"""Arrays of an npz by their names, each held against a bound before it is unpacked; nothing is unpickled.

A name stands for the member with the suffix .npy alone. numpy prefers one without, which no bound would be of.
"""

import zipfile
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import InputError, SourceError
from kinetree.tasks.numerics.input.unpacked import bomb

_SUFFIX = ".npy"
_HEADER_BYTES = 2**14
"""Of a member in which its header ends: numpy takes none of more than 10,000."""


def npz_arrays(
    path: Path, names: Sequence[str], error: type[InputError], allowed: int | None = None
) -> dict[str, NDArray[Any]]:
    """Those arrays of an npz that are there.

    names   : of the arrays that are wanted
    allowed : bytes to which an array may unpack however few are stored; as `bomb` has it if not said
    raises  : `error` where an array would unpack to more, and what zipfile and numpy raise of damaged bytes
    """
    with zipfile.ZipFile(path) as archive:
        members = {name: info for name in names if (info := archive.NameToInfo.get(name + _SUFFIX))}
        for name, info in members.items():
            if why := bomb(info.compress_size, info.file_size, allowed):
                raise error(f"{path}: {name}: {why}")
        return {name: _array(archive, info) for name, info in members.items()}


def npz_shapes(path: Path) -> dict[str, tuple[int, ...]]:
    """Names and shapes of the arrays of an npz, without reading them; raises SourceError."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {name.removesuffix(_SUFFIX): _shape(archive, name) for name in archive.namelist() if name.endswith(_SUFFIX)}
    except Exception as error:
        raise SourceError(f"{path}: cannot be read as .npz ({type(error).__name__}: {error})") from None


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(member) as file:
        array: NDArray[Any] = np.lib.format.read_array(file, allow_pickle=False)
    return array


def _shape(archive: zipfile.ZipFile, name: str) -> tuple[int, ...]:
    with archive.open(name) as file:
        head = BytesIO(file.read(_HEADER_BYTES))
    version = np.lib.format.read_magic(head)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    return tuple(int(n) for n in read(head)[0])
