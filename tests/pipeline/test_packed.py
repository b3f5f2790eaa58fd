"""The list of a zip is read alike by the short way and by Python's own reader; what is not plain goes the long way."""

import io
import zipfile

import pytest

from kinetree.pipeline.storage.packed import DamagedZipError, _any_spans, _plain_spans, packed

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
    for at in range(begin, len(data)):
        altered = data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :]
        plain = _plain_spans(altered, len(altered))
        try:
            known = _any_spans(altered, len(altered))
        except DamagedZipError:
            known = {}
        assert plain in ({}, known), at
