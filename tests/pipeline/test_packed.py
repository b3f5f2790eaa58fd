"""The list of a zip is read alike by the short way and by Python's own reader; what is not plain goes the long way."""

import io
import itertools
import zipfile
from dataclasses import dataclass

import pytest

from kinetree.pipeline.storage.packed import TAIL_BYTES, DamagedZipError, Packed, _any_spans, _plain_spans, packed

FILES = {"zarr.json": b"{}", "empty": b"", "positions/c/0/0": bytes(range(256)), "été": b"1"}


def written(files: dict[str, bytes], comment: bytes = b"", extra: bytes = b"", is_deflated: bool = False) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED if is_deflated else zipfile.ZIP_STORED) as archive:
        archive.comment = comment
        for name, data in files.items():
            member = zipfile.ZipInfo(name)
            member.compress_type, member.extra = archive.compression, extra
            archive.writestr(member, data)
    return out.getvalue()


@pytest.mark.parametrize("count", [1, 3])
def test_both_ways_give_the_same_list_in_the_same_order(count: int) -> None:
    data = packed(dict(list(FILES.items())[:count]))
    assert list(_plain_spans(data, len(data)).items()) == list(_any_spans(data, len(data)).items())
    assert len(_plain_spans(data, len(data))) == count


def test_end_of_a_zip_is_enough() -> None:
    data = packed({"first": bytes(5000), "second": b"2"})
    tail = data[-300:]
    assert _plain_spans(tail, len(data)) == _any_spans(data, len(data))


@pytest.mark.parametrize(
    "data",
    [
        b"",
        packed({}),
        packed({"a": b"1"})[:-1],
        packed({"été": b"1"}),
        written({"a": b"1"}, comment=b"more"),
        written({"a": b"1"}, extra=b"\x01\x00\x01\x00x"),
        written({"a": bytes(99)}, is_deflated=True),
    ],
    ids=["nothing", "no file", "cut short", "name of other letters", "comment", "more beside a name", "deflated"],
)
def test_what_is_not_plain_goes_the_long_way(data: bytes) -> None:
    assert _plain_spans(data, len(data)) == {}


def test_no_altered_byte_of_the_list_gives_another_list_than_the_long_way() -> None:
    data = packed({"zarr.json": b"{}", "a/c/0": b"123"})
    begin = data.index(b"PK\x01\x02")
    for at, value in itertools.product(range(begin, len(data)), range(256)):
        altered = data[:at] + bytes([value]) + data[at + 1 :]
        plain = _plain_spans(altered, len(altered))
        try:
            known = _any_spans(altered, len(altered))
        except DamagedZipError:
            known = {}
        assert plain in ({}, known), (at, value)


@dataclass
class Bytes:
    """One object; what is asked for later than its end may be gone."""

    data: bytes
    is_gone: bool = False

    def tail(self, path: str, count: int) -> tuple[bytes, int]:
        return self.data[-count:], len(self.data)

    def part(self, path: str, start: int, stop: int) -> bytes | None:
        return None if self.is_gone else self.data[start:stop]


LONG = packed({f"{n:0200}": b"" for n in range(600)})
"""A zip whose list is longer than what is read first."""


@pytest.mark.parametrize(
    "data",
    [*(packed(FILES)[:n] for n in range(len(packed(FILES)))), packed({}), LONG[:-1], LONG[TAIL_BYTES:]],
)
def test_what_is_cut_short_or_holds_nothing_is_damaged(data: bytes) -> None:
    with pytest.raises(DamagedZipError):
        Packed.at(Bytes(data), "a")


def test_a_zip_that_holds_nothing_says_so() -> None:
    with pytest.raises(DamagedZipError, match="it holds nothing"):
        Packed.at(Bytes(packed({})), "a")


def test_a_list_longer_than_the_tail_is_read_whole_unless_it_is_gone() -> None:
    group = Packed.at(Bytes(LONG), "a")
    assert group is not None
    assert len(group.spans) == 600
    with pytest.raises(DamagedZipError, match="missing"):
        Packed.at(Bytes(LONG, is_gone=True), "a")


def test_files_that_overlap_in_a_list_go_the_long_way_and_are_refused() -> None:
    data = packed({"a": b"1", "b": b"2"})
    size_at = data.index(b"PK\x01\x02") + 20
    taken = (60).to_bytes(4, "little")
    altered = data[:size_at] + 2 * taken + data[size_at + 8 :]
    assert _plain_spans(altered, len(altered)) == {}
    with pytest.raises(DamagedZipError, match="contradicts itself"):
        Packed.at(Bytes(altered), "a")
