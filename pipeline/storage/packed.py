"""Many small files as one object: an uncompressed zip, of which any part can be read without the others."""

import io
import struct
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

TAIL_BYTES = 2**16
"""Read at once from the end of a zip: the list of what it holds, and most small ones whole."""
_LOCAL = struct.Struct("<4s22xHH")
"""What precedes a file in a zip: signature, lengths of its name and of what else stands before its bytes."""
_SIGNATURE = b"PK\x03\x04"
_LISTED = struct.Struct("<4s2xHHH4xIIIHHHHHII")
"""A file in the list of a zip: signature, version needed, flags, method, CRC-32, sizes packed and unpacked,
lengths of its name, of what else stands beside it and of its comment, disk, two attributes, where its entry begins."""
_END = struct.Struct("<4s4HIIH")
"""What ends a zip: signature, two disks, files on this one and in all, size and place of the list, length of a comment."""
_UTF8 = 0x800
_VERSION = 20
"""What Python says is needed to read a zip without anything special."""
_WRITTEN = (1980, 1, 1, 0, 0, 0)
"""The time of every file: equal files make equal zips."""


class DamagedZipError(Exception):
    """The bytes are no zip as this module writes them, or were altered."""


class Parts(Protocol):
    """Where a zip lies."""

    def tail(self, path: str, count: int) -> tuple[bytes, int] | None:
        """The last bytes of an object, and how many it has in all; None where nothing is."""

    def part(self, path: str, start: int, stop: int) -> bytes | None:
        """The bytes from start to stop; None where nothing is."""


def packed(files: Mapping[str, bytes], *, is_deflated: bool = False) -> bytes:
    """The files as one zip, in their order."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED if is_deflated else zipfile.ZIP_STORED) as archive:
        for name, data in files.items():
            member = zipfile.ZipInfo(name, _WRITTEN)
            member.compress_type = archive.compression
            archive.writestr(member, data)
    return out.getvalue()


@dataclass(frozen=True)
class Packed:
    """The files of one uncompressed zip, read when they are asked for."""

    place: Parts
    path: str
    spans: Mapping[str, tuple[int, int, int, int]]
    """By name: where the file's entry begins, where the next begins, its size and its CRC-32."""
    tail: bytes
    size: int

    @staticmethod
    def at(place: Parts, path: str) -> "Packed | None":
        """The zip at a path, of which only the list is read; None where nothing is.

        raises : DamagedZipError
        """
        tail = place.tail(path, TAIL_BYTES)
        if tail is None:
            return None
        try:
            return Packed(place, path, _spans(*tail), *tail)
        except _Outside:
            whole = place.part(path, 0, tail[1])  # the list alone is longer than the tail
            if whole is None:
                raise DamagedZipError("it is missing or cut short") from None
            return Packed(place, path, _spans(whole, len(whole)), whole, len(whole))

    def read(self, names: Iterable[str]) -> dict[str, bytes]:
        """The bytes of some files, in one piece where they lie beside each other; raises DamagedZipError, KeyError."""
        spans = {name: self.spans[name] for name in names}
        if not spans:
            return {}
        first, last = min(s[0] for s in spans.values()), max(s[1] for s in spans.values())
        data = self._bytes(first, last)
        return {name: _content(data[begin - first : end - first], size, crc) for name, (begin, end, size, crc) in spans.items()}

    def _bytes(self, start: int, stop: int) -> bytes:
        offset = self.size - len(self.tail)
        if start >= offset:
            return self.tail[start - offset : stop - offset]
        data = self.place.part(self.path, start, stop)
        if data is None or len(data) != stop - start:
            raise DamagedZipError("it is missing or cut short")
        return data


class _Outside(Exception):
    """More of the zip is needed than was read."""


def _spans(tail: bytes, size: int) -> dict[str, tuple[int, int, int, int]]:
    """Where every file lies, from the end of a zip."""
    return _plain_spans(tail, size) or _any_spans(tail, size)


def _plain_spans(tail: bytes, size: int) -> dict[str, tuple[int, int, int, int]]:
    """The same of a zip as `packed` writes it, in less time; empty of any other, and where something is altered."""
    end_at = len(tail) - _END.size
    if end_at < 0:
        return {}
    signature, disk, of_list, here, count, length, list_at, comment = _END.unpack_from(tail, end_at)
    at = list_at - (size - len(tail))
    if signature != b"PK\x05\x06" or disk or of_list or here != count or comment or at < 0 or at + length != end_at:
        return {}
    entries = sorted(_plain_entries(tail[at:end_at]))
    if len(entries) != count or not count:
        return {}
    stops = [*(entry[0] for entry in entries[1:]), list_at]
    spans = {name: (begin, stop, taken, crc) for (begin, taken, crc, name), stop in zip(entries, stops, strict=True)}
    is_sound = len(spans) == count and all(begin + taken <= stop for begin, stop, taken, _ in spans.values())
    return spans if is_sound else {}


def _plain_entries(listed: bytes) -> list[tuple[int, int, int, str]]:
    """Of every file in a list: where its entry begins, its size, CRC-32 and name; empty where one is not plain."""
    entries, at = [], 0
    while at < len(listed):
        if at + _LISTED.size > len(listed):
            return []
        mark, needed, flags, method, crc, stored, size, name, extra, note, disk, _, _, begin = _LISTED.unpack_from(listed, at)
        text = listed[at + _LISTED.size : at + _LISTED.size + name]
        at += _LISTED.size + name
        is_plain = mark == b"PK\x01\x02" and needed == _VERSION
        is_plain = is_plain and not (flags & ~_UTF8 or method or stored != size or extra or note or disk)
        if not is_plain or not text.isascii() or b"\0" in text:
            return []
        entries.append((begin, size, crc, text.decode()))
    return entries if at == len(listed) else []


def _any_spans(tail: bytes, size: int) -> dict[str, tuple[int, int, int, int]]:
    """The same of any zip, by way of Python's own reader; raises DamagedZipError."""
    offset = size - len(tail)
    window = _Window(tail, offset)
    try:
        with zipfile.ZipFile(window) as archive:
            infos, list_at = sorted(archive.infolist(), key=lambda info: info.header_offset), archive.start_dir
    except _Outside:
        raise
    except Exception as error:  # zipfile raises many kinds for altered bytes
        raise DamagedZipError(f"its list of files cannot be read ({type(error).__name__})") from error
    if any(i.compress_type != zipfile.ZIP_STORED or i.file_size != i.compress_size or i.flag_bits & 1 for i in infos):
        raise DamagedZipError("its files are compressed or encrypted")
    if not infos:
        raise DamagedZipError("it holds nothing")
    stops = [*(info.header_offset for info in infos[1:]), list_at]
    spans = {i.filename: (i.header_offset, stop, i.file_size, i.CRC) for i, stop in zip(infos, stops, strict=True)}
    if len(spans) != len(infos) or any(begin < 0 or begin + taken > stop for begin, stop, taken, _ in spans.values()):
        raise DamagedZipError("its list of files contradicts itself")
    return spans


def _content(entry: bytes, size: int, crc: int) -> bytes:
    if len(entry) < _LOCAL.size + size or entry[:4] != _SIGNATURE:
        raise DamagedZipError("a file in it is cut short")
    _, name, extra = _LOCAL.unpack_from(entry)
    begin = _LOCAL.size + name + extra
    data = entry[begin : begin + size]
    if len(data) != size or zlib.crc32(data) != crc:
        raise DamagedZipError("a file in it was altered")
    return data


class _Window(io.RawIOBase):
    """The end of a file, as if it were all of it; what lies before cannot be read."""

    def __init__(self, tail: bytes, offset: int) -> None:
        self._tail, self._offset, self._at = tail, offset, 0

    def seekable(self) -> bool:
        return True

    def readable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = 0) -> int:
        at = offset + (0, self._at, self._offset + len(self._tail))[whence]
        if at < 0:  # as a file says it: Python's reader seeks there where a file is shorter than the record of its end
            raise OSError("before the beginning")
        self._at = at
        return at

    def tell(self) -> int:
        return self._at

    def readinto(self, buffer: "bytearray | memoryview") -> int:  # type: ignore[override]
        if self._at < self._offset:
            raise _Outside
        data = self._tail[self._at - self._offset :][: len(buffer)]
        buffer[: len(data)] = data
        self._at += len(data)
        return len(data)
