"""Lines of a text, a piece of it at a time: a list of all lines takes many times the text's bytes."""

import re
from collections.abc import Iterator

from kinetree.errors import MeshError

_PIECE_BYTES = 2**20
_LONGEST_BYTES = 2**24
"""Of one line, with those that it goes on in: a polygon of a million corners."""
_END = re.compile(rb"\r\n|(?<!\r)\n|\r(?!\n)")
_END_OF_ALL = re.compile(rb"(?<!\\)\r\n|(?<![\\\r])\n|\r(?!\n)")
"""The end of a line that does not go on in the next."""


def text_lines(raw: bytes, *, are_continued: bool = False) -> Iterator[bytes]:
    """Every line without its end.

    are_continued : whether a backslash at the end of a line joins the next one to it, a blank between them
    raises        : MeshError where a line is longer than any row of a mesh
    """
    pattern, begin = _END_OF_ALL if are_continued else _END, 0
    while begin < len(raw):
        found = pattern.search(raw, begin + _PIECE_BYTES)
        end = found.end() if found else len(raw)
        if end - begin > _PIECE_BYTES + _LONGEST_BYTES:
            raise MeshError(f"a line of more than {_LONGEST_BYTES} bytes; the file is damaged or no mesh")
        piece = raw[begin:end]
        if are_continued:
            piece = piece.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
        yield from piece.splitlines()
        begin = end
