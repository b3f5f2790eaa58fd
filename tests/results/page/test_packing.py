"""Arrays come back from a stream as they were, also where some of them follow later."""

import zlib

import numpy as np
import numpy.typing as npt
import pytest

from kinetree.tasks.results.page.packing import Packing

FIRST = {"a": np.arange(5, dtype=np.uint8), "b": np.arange(6, dtype=np.float32).reshape(2, 3), "c": np.zeros(0, np.uint16)}
LATER = {"d": np.arange(70_000, dtype=np.uint32), "e": np.full(3, 7, np.int16)}


def unpacked(packing: Packing) -> dict[str, npt.NDArray[np.generic]]:
    raw = zlib.decompress(packing.ended())
    return {
        name: np.frombuffer(raw, a["dtype"], int(np.prod(a["shape"])), a["offset"]).reshape(a["shape"])
        for name, a in packing.layout.items()
    }


@pytest.mark.parametrize("later", [{}, LATER])
def test_arrays_come_back_as_they_were_and_lie_where_a_browser_can_read_them(later: dict[str, npt.NDArray[np.generic]]) -> None:
    packing = Packing({}).followed_by(FIRST).followed_by(later)
    back = unpacked(packing)
    assert list(back) == [*FIRST, *later]
    for name, array in {**FIRST, **later}.items():
        assert packing.layout[name]["offset"] % 4 == 0
        np.testing.assert_array_equal(back[name], array)


def test_a_stream_that_was_stored_is_continued_as_if_it_had_not_been() -> None:
    begun = Packing({}).followed_by(FIRST)
    restored = Packing(dict(begun.layout), bytes(begun.stream), begun.size, begun.checksum)
    assert restored.followed_by(LATER).ended() == begun.followed_by(LATER).ended()
    assert unpacked(begun).keys() == FIRST.keys()


def test_stream_of_nothing_unpacks_to_nothing() -> None:
    assert zlib.decompress(Packing({}).ended()) == b""
