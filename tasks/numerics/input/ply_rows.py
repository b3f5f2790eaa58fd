"""Whether a PLY file holds what its header claims: a row too few, too many or of another length shifts or loses the rest."""

import itertools
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input.text_lines import text_lines

_MOST_PROPERTIES = 1000
"""Of a header; meshes have some ten, and each is looked for in every row."""
_QUOTED = 60
"""Characters of a row that a message quotes."""


class Element(NamedTuple):
    """One kind of rows: its name, how many the header claims, and which of its properties are lists."""

    name: str
    rows: int
    lists: tuple[bool, ...]


def elements(header: bytes) -> list[Element]:
    """What a header claims, in its order; other lines are passed over; raises MeshError where it has too many properties."""
    claimed: list[tuple[str, int, list[bool]]] = []
    properties = 0
    for line in header.splitlines():
        words = line.decode("utf-8", "replace").split()
        if len(words) >= 3 and words[0] == "element" and re.fullmatch(r"-?[0-9]{1,300}", words[2]):
            claimed.append((words[1], int(words[2]), []))
        elif len(words) >= 3 and words[0] == "property" and claimed:
            claimed[-1][2].append(words[1] == "list")
            properties += 1
        if properties > _MOST_PROPERTIES:
            raise MeshError(f"its header has more than {_MOST_PROPERTIES} properties; the file is damaged or no mesh")
    return [Element(name, rows, tuple(lists)) for name, rows, lists in claimed]


def refuse_wrong_rows(claimed: list[Element], body: bytes) -> None:
    """Refuses the text after the header if its lines are not the rows that the header claims; raises MeshError."""
    count, follow = sum(element.rows for element in claimed), sum(not line.isspace() for line in text_lines(body) if line)
    if follow < count:
        raise MeshError(f"its header claims {count} lines, {follow} follow; the file is cut short")
    if follow > count:
        raise MeshError(
            f"{lines(follow - count)} after the {count} that its header claims: something would be left out; the file is"
            " damaged or badly written, export it again"
        )
    rows = (words for line in text_lines(body) if (words := line.split()))
    for name, number, lists in claimed:
        for i, words in enumerate(itertools.islice(rows, number)):
            if not _fits(words, lists, 3 if name == "face" else 0):
                row = b" ".join(words).decode("utf-8", "replace")[:_QUOTED]
                raise MeshError(
                    f"{name} {i} is {row!r}, which is not what its header says; the file is damaged, export it again"
                )


def refuse_wrong_faces(face: Mapping[str, Any]) -> None:
    """Refuses binary faces whose lists are not all as long as the first, or are no whole numbers; raises MeshError.

    face : the element as trimesh keeps it: its `data` has a list as a record of its length `f0` and its numbers `f1`
    """
    data: Any = face.get("data")
    for name in getattr(data, "dtype", np.dtype("f8")).names or ():
        record = data[name]
        if record.dtype.names is None:
            continue
        lengths = record["f0"].astype(np.int64)
        wrong = np.flatnonzero(lengths != lengths[:1])
        if len(wrong):
            raise MeshError(
                f"face {wrong[0]} has {lengths[wrong[0]]} corners where the first has {lengths[0]}; the file is damaged, or is"
                " binary and mixes triangles with larger polygons: triangulate it when exporting, or save it as ASCII"
            )
        if name.startswith("vert") and record["f1"].dtype.kind not in "iu":
            kind = record["f1"].dtype.name
            raise MeshError(f"its faces are numbers of type {kind}, not whole ones; the file is badly written, export it again")


def lines(more: int) -> str:
    """How many lines there are beyond what was claimed."""
    return f"{more} more line{'' if more == 1 else 's'}"


def _fits(words: list[bytes], lists: tuple[bool, ...], corners: int) -> bool:
    """Whether a row has exactly these properties, its lists whole numbers and, in faces, of three or more."""
    at = 0
    try:
        for is_list in lists:
            if is_list:
                length = int(words[at])
                if length < corners:
                    return False
                corners = 0  # those of textures may be fewer
                at += 1 + length
            else:
                float(words[at])
                at += 1
        first = lists.index(True) if True in lists else -1
        if first == 0:
            for word in words[1 : 1 + int(words[0])]:
                int(word)
    except (ValueError, IndexError):
        return False
    return at == len(words)
