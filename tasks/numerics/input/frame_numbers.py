"""The number of every frame, read from the names of files where these are numbered (2014, Sec. 3 assumes numbered frames).

A number that is missing stays missing, so that frame 3 is frame_0003.ply whatever lies beside it.
"""

import re
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from pathlib import PurePath

from kinetree.errors import SourceError

MOST_DIGITS = 9
"""Digits of a frame number; a longer number in a name is a time or a digest, and the files are numbered in their order."""


TAKE = 10**MOST_DIGITS
"""Frame t of take k has the number k · TAKE + t, so that the numbers alone say where a take begins."""


def take_spans(frames: Sequence[int]) -> list[slice]:
    """The positions of every take's frames, takes in their order.

    frames : numbers, ascending
    """
    begins = [0, *(i for i, (a, b) in enumerate(pairwise(frames), 1) if b // TAKE > a // TAKE)]
    return [slice(a, b) for a, b in pairwise([*begins, len(frames)])]


def frame_numbers(files: Sequence[PurePath]) -> list[int]:
    """The number of every file: the one number that runs in their names; 0, 1, 2, … in their order where none does.

    files  : in natural order, one a frame
    raises : SourceError where the names are of several series, or two files have one number
    """
    names = [re.split(r"([0-9]+)", str(path.with_suffix(""))) for path in files]
    series = Counter(tuple(text.casefold() for text in name[::2]) for name in names)
    if len(series) > 1:
        if max(series.values()) > 1:
            _refuse_several(files, [tuple(text.casefold() for text in name[::2]) for name in names])
        return list(range(len(files)))
    numbers = [[int(digits) if len(digits) <= 4000 else -1 for digits in name[1::2]] for name in names]
    running = [k for k in range(len(numbers[0])) if len({row[k] for row in numbers}) > 1]
    if not running:
        if len(files) > 1:
            _refuse_equal(files[0], files[1])
        return list(range(len(files)))
    column = _ascending(numbers, running)
    if column is None:
        _refuse_repeated(files, numbers, running)
        return list(range(len(files)))
    return column if are_frame_numbers(column) else list(range(len(files)))


def are_frame_numbers(numbers: Sequence[int]) -> bool:
    """Whether all are short enough to count frames."""
    return all(0 <= number < 10**MOST_DIGITS for number in numbers)


def selected_frames(text: str, numbers: Sequence[int], where: str) -> list[int]:
    """The frame numbers that start:stop:step selects; a negative start or stop counts from the end.

    numbers : of all frames, ascending
    raises  : SourceError where the text is no range or selects nothing
    """
    parts = text.split(":")
    try:
        start, stop, step = ([int(p) if p.strip() else None for p in parts] + [None, None])[:3]
        if len(parts) not in (2, 3) or step == 0:
            raise ValueError
    except ValueError:
        raise SourceError(f"frames {text!r}: write start:stop or start:stop:step, e.g. 10:60:2") from None
    if step is not None and step < 0:
        raise SourceError(f"frames {text!r}: the step must be positive; time runs forward")
    first, end = numbers[0], numbers[-1] + 1
    begin = first if start is None else max(end + start, first) if start < 0 else start
    beyond = end if stop is None else end + stop if stop < 0 else stop
    wanted = range(begin, beyond, step or 1)
    chosen = [number for number in numbers if number in wanted]
    if not chosen:
        numbered = f", numbered {first} to {end - 1}" if first or end > len(numbers) else ""
        raise SourceError(f"frames {text!r} selects none of the {len(numbers)} frames of {where}{numbered}")
    return chosen


def _ascending(numbers: Sequence[Sequence[int]], running: Sequence[int]) -> list[int] | None:
    """The numbers in the first place of the names where they ascend from file to file; None where there is none."""
    columns = ([row[k] for row in numbers] for k in running)
    return next((c for c in columns if all(a < b for a, b in pairwise(c))), None)


def _refuse_several(files: Sequence[PurePath], kinds: Sequence[tuple[str, ...]]) -> None:
    """Files whose names differ in more than numbers."""
    usual = Counter(kinds).most_common(1)[0][0]
    one = files[kinds.index(usual)]
    other = next(path for path, kind in zip(files, kinds, strict=True) if kind != usual)
    raise SourceError(
        f"{one} and {other}: names of several series ({_counts(kinds)}); the frames of one body have names that differ"
        f" in one number alone; choose by a pattern such as {one.parent / _pattern(one)}"
    )


def _refuse_repeated(files: Sequence[PurePath], numbers: Sequence[Sequence[int]], running: Sequence[int]) -> None:
    """Files of one folder whose last number begins again, such as walk1_0001 and walk2_0001."""
    file_of_number: dict[tuple[PurePath, int], PurePath] = {}
    for path, row in zip(files, numbers, strict=True):
        other = file_of_number.setdefault((path.parent, row[running[-1]]), path)
        if other is not path:
            _refuse_equal(other, path)


def _refuse_equal(one: PurePath, other: PurePath) -> None:
    """Two files of one number."""
    raise SourceError(
        f"{one} and {other}: two files have the same number; the frames of one body have names that differ in one running"
        " number; choose those of one body by a pattern, or take one of the two away"
    )


def _counts(kinds: Sequence[tuple[str, ...]]) -> str:
    """How many files there are of the first few series."""
    counted = Counter(PurePath("#".join(kind)).name for kind in kinds).most_common()
    return ", ".join(f"{n} × {name}" for name, n in counted[:4]) + (", …" if len(counted) > 4 else "")


def _pattern(path: PurePath) -> str:
    """The file's name with a star in place of its last number."""
    return re.sub(r"[0-9]+(?=[^0-9]*$)", "*", path.stem) + path.suffix
