"""How large a file may be and to how much it may unpack; both are held against bounds before memory is taken."""

import bz2
import zlib
from pathlib import Path
from typing import BinaryIO

UNPACKED_BYTES = 256 * 2**20
"""What unpacks to more bytes than this …"""
UNPACKED_RATIO = 100
"""… may not be more than this many times its packed bytes: packed meshes shrink to a tenth at best."""
_DEFLATE_RATIO = 1032
"""No bytes packed by deflate unpack to more than this many times as many."""
_CHUNK_BYTES = 2**20


def bomb(stored: int, unpacked: int, allowed: int | None = None) -> str:
    """Why packed bytes are not unpacked, empty where they are.

    stored   : bytes as they lie in the file
    unpacked : bytes that they claim to become
    allowed  : as many are unpacked however few are stored; UNPACKED_BYTES if not said
    """
    if unpacked <= (UNPACKED_BYTES if allowed is None else allowed) or unpacked <= UNPACKED_RATIO * stored:
        return ""
    return f"{stored} bytes would unpack to {unpacked}; expected at most {UNPACKED_RATIO} times as many"


def unpacks_beyond(file: BinaryIO, encoding: str, stored: int, most: int) -> bool:
    """Whether what is left of a file unpacks to more than `most` bytes; of those, no more than a piece is kept at a time.

    encoding : gzip or bzip2
    stored   : bytes that are left of the file
    raises   : what zlib and bz2 raise of damaged bytes
    """
    is_deflate = encoding.startswith("gz")
    if is_deflate and _DEFLATE_RATIO * stored <= most:
        return False
    unpacker = zlib.decompressobj(zlib.MAX_WBITS | 16) if is_deflate else bz2.BZ2Decompressor()
    size = 0
    while not unpacker.eof and size <= most:
        packed = file.read(_CHUNK_BYTES)
        if not packed:
            break
        size += _unpacked(unpacker, packed, most - size)
    return size > most


def _unpacked(unpacker: "zlib._Decompress | bz2.BZ2Decompressor", packed: bytes, most: int) -> int:
    """How many bytes some packed bytes become, counted up to a little more than `most`."""
    size = 0
    while size <= most:
        piece = unpacker.decompress(packed, _CHUNK_BYTES)
        size += len(piece)
        packed = b"" if isinstance(unpacker, bz2.BZ2Decompressor) else unpacker.unconsumed_tail
        is_done = unpacker.needs_input if isinstance(unpacker, bz2.BZ2Decompressor) else not packed
        if unpacker.eof or (is_done and len(piece) < _CHUNK_BYTES):
            break
    return size


def too_large(path: Path, most: int) -> str:
    """Why a file is not read at all, empty where it is; raises OSError."""
    size = path.stat().st_size
    return f"{size} bytes; more than {most} are not read of one frame" if size > most else ""
