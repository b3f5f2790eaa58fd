"""What a binary glTF holds: its document and its arrays, each held against the bytes that are there before it is read.

Source: Khronos Group, glTF 2.0 Specification, Sec. 3.6 (binary data storage) and 4.4 (the container).
"""

import base64
import binascii
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from kinetree.errors import SourceError
from kinetree.tasks.numerics.arrays import Floats

_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_READ = {"KHR_mesh_quantization", "KHR_texture_transform", "KHR_materials_unlit", "KHR_lights_punctual"}
"""Extensions that a file may require: those that change nothing of where vertices are, or that accessors already say."""
_NUMBER_BYTES = 8
_MOST_BYTES = 2**31
"""Of one array as numbers; no body comes near this."""


@dataclass(frozen=True)
class Gltf:
    """A document and the bytes beside it.

    document : as in the file
    binary   : the chunk of bytes that follows it
    """

    document: Mapping[str, Any]
    binary: bytes

    @classmethod
    def of(cls, raw: bytes) -> "Gltf":
        """From the bytes of a .glb; raises SourceError where they are none, or need what is not read."""
        if raw[:4] != b"glTF" or len(raw) < 20 or int.from_bytes(raw[8:12], "little") > len(raw):
            raise SourceError("no complete binary glTF; the file is damaged, cut short or something else")
        end = 20 + int.from_bytes(raw[12:16], "little")
        try:
            document = json.loads(raw[20:end])
        except (ValueError, RecursionError) as error:
            raise SourceError(f"its JSON cannot be read ({type(error).__name__}); the file is damaged") from None
        if not isinstance(document, dict):
            raise SourceError("its JSON is no document; the file is damaged")
        if unread := sorted(set(map(str, _list(document.get("extensionsRequired")))) - _READ):
            raise SourceError(f"uses {', '.join(unread)}, which is not read; export it uncompressed")
        binary = (
            raw[end + 8 : end + 8 + int.from_bytes(raw[end : end + 4], "little")] if raw[end + 4 : end + 8] == b"BIN\0" else b""
        )
        return cls(document, binary)

    def items(self, kind: str) -> Sequence[Mapping[str, Any]]:
        """The objects of one kind: nodes, meshes, skins, animations, accessors …; raises SourceError where they are none."""
        objects = _list(self.document.get(kind))
        if not all(isinstance(one, dict) for one in objects):
            raise SourceError(f"{kind} is no list of objects; the file is damaged")
        return objects

    def item(self, kind: str, index: Any) -> Mapping[str, Any]:
        """One of them by its number; raises SourceError where there is none."""
        objects = self.items(kind)
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(objects):
            raise SourceError(f"names {kind} {index!r}, but there are {len(objects)}; the file is damaged")
        return objects[index]

    def array(self, index: Any) -> Floats:
        """An accessor's numbers, (count,), (count, width) or (count, 4, 4) for matrices; normalized ones within [-1, 1].

        raises : SourceError where it claims more than the file holds
        """
        accessor = self.item("accessors", index)
        count, width, dtype = self._layout(index)
        if "bufferView" in accessor:
            stored = self._view(accessor["bufferView"], accessor.get("byteOffset", 0), dtype, count, width)
        else:
            stored = np.zeros((count, width), dtype)
        if isinstance(sparse := accessor.get("sparse"), dict):
            stored = self._replaced(stored, sparse, dtype, index)
        values = stored.astype(np.float64)
        if accessor.get("normalized") and np.dtype(dtype).kind in "iu":
            values = np.maximum(values / np.iinfo(dtype).max, -1.0)
        if width == 16:
            return values.reshape(count, 4, 4).transpose(0, 2, 1)  # columns first in the file
        return values[:, 0] if width == 1 else values

    def size(self, index: Any) -> int:
        """Bytes of an accessor's numbers, as `array` gives them; raises SourceError where they are too many for any body."""
        count, width, _ = self._layout(index)
        return count * width * _NUMBER_BYTES

    def _layout(self, index: Any) -> tuple[int, int, str]:
        """Count, width and type of an accessor's rows; raises SourceError where they are unknown or too large."""
        accessor = self.item("accessors", index)
        count, width = whole(accessor.get("count")), _WIDTHS.get(str(accessor.get("type")))
        dtype = _DTYPES.get(accessor.get("componentType", 0))
        if width is None or dtype is None or count * width * _NUMBER_BYTES > _MOST_BYTES:
            raise SourceError(f"accessor {index} is of no known or of too large a layout; the file is damaged")
        return count, width, dtype

    def _replaced(self, dense: Any, sparse: Mapping[str, Any], dtype: str, index: Any) -> Any:
        """An array some of whose rows are given apart."""
        count = whole(sparse.get("count"))
        indices, values = _dict(sparse.get("indices")), _dict(sparse.get("values"))
        kind = _DTYPES.get(indices.get("componentType", 0), "<u4")
        rows = self._view(indices.get("bufferView"), indices.get("byteOffset", 0), kind, count, 1)[:, 0].astype(np.int64)
        if ((rows < 0) | (rows >= len(dense))).any():
            raise SourceError(f"accessor {index} replaces rows that it has not; the file is damaged")
        changed = dense.copy()
        changed[rows] = self._view(values.get("bufferView"), values.get("byteOffset", 0), dtype, count, dense.shape[1])
        return changed

    def _view(self, index: Any, offset: Any, dtype: str, count: int, width: int) -> Any:
        """(count, width) of one kind out of a view of a buffer."""
        view = self.item("bufferViews", index)
        data = self._buffers[whole(view.get("buffer", 0))] if whole(view.get("buffer", 0)) < len(self._buffers) else b""
        size = np.dtype(dtype).itemsize * width
        stride = whole(view.get("byteStride", size))
        begin = whole(view.get("byteOffset", 0)) + whole(offset)
        end = begin + stride * (count - 1) + size if count else begin
        if stride < size or end > len(data):
            raise SourceError(f"view {index} runs to byte {end} of {len(data)}; the file is damaged or cut short")
        return (
            np.ndarray((count, width), dtype, data, begin, (stride, np.dtype(dtype).itemsize))
            if count
            else np.zeros((0, width))
        )

    @cached_property
    def _buffers(self) -> list[bytes]:
        """The bytes of each buffer; raises SourceError where they lie in another file."""
        buffers = []
        for buffer in self.items("buffers"):
            uri = buffer.get("uri")
            if uri is None:
                buffers.append(self.binary)
            elif str(uri).startswith("data:") and ";base64," in str(uri)[:200]:
                try:
                    buffers.append(base64.b64decode(str(uri).partition(",")[2], validate=True))
                except binascii.Error:
                    raise SourceError("a buffer is no base64; the file is damaged") from None
            else:
                raise SourceError(
                    f"keeps its data outside itself, in {str(uri)[:80]!r}, which is not opened; export it as one file"
                )
        return buffers


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _dict(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def whole(value: Any) -> int:
    """A count or an offset; raises SourceError where it is none."""
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**40:
        raise SourceError(f"a count or an offset is {str(value)[:20]!r}; the file is damaged")
    return value
