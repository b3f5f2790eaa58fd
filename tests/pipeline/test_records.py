"""Records alone and in packs: what was written is found in either place, and what cannot be read is none."""

import io
import zipfile
from dataclasses import asdict

import pytest

from kinetree.pipeline.storage import records as records_module
from kinetree.pipeline.storage.packed import packed
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.records import PACKED_FROM, RECORD_BYTES, Record, Records
from kinetree.pipeline.storage.sealed import sealed, unsealed

KEYS = [f"{n:040x}" for n in range(PACKED_FROM)]


def record(key, **changes):
    return Record(**{
        "key": key, "task": "points", "index": {"frame": 3}, "artifact": "ab" * 20, "bytes": 3, "params": {},
        "code": {"a": "b"}, "inputs": [], "seconds": 0.5, "peak_bytes": 1, "host": "here", "created": "now", **changes,
    })  # fmt: skip


@pytest.fixture
def place(tmp_path):
    return Folder(tmp_path / "store")


@pytest.fixture
def records(place):
    filled = Records(place)
    for key in KEYS:
        filled.put(record(key))
    return filled


def test_records_are_found_alone_and_packed(place, records):
    assert records.get(KEYS[3]) == Records(place).get(KEYS[3]) == record(KEYS[3])
    records.pack("run", KEYS)
    assert (place.names("records"), place.names("packs")) == ([], ["run.zip"])
    assert [r.key for r in records.all()] == [r.key for r in Records(place).all()] == KEYS
    assert records.get("f" * 40) is None


def test_few_records_and_those_of_others_are_left_alone(place, records):
    records.pack("run", KEYS[1:])
    assert len(place.names("records")) == PACKED_FROM
    records.put(record("f" * 40))
    records.pack("run", KEYS)
    assert place.names("records") == [f"{'f' * 40}.json"]


def test_reader_that_looked_before_a_pack_finds_its_records_after(place, records):
    reader = Records(place)
    assert reader.get(KEYS[0])
    records.pack("run", KEYS)
    assert reader.get(KEYS[5]) == record(KEYS[5])


def test_record_written_again_counts_before_the_packed_one(place, records):
    records.pack("run", KEYS)
    records.put(record(KEYS[0], seconds=7.0))
    assert records.get(KEYS[0]).seconds == Records(place).get(KEYS[0]).seconds == 7.0


def test_record_of_another_writer_is_found_at_once(place, records):
    reader = Records(place)
    assert reader.get("f" * 40) is None
    records.put(record("f" * 40))
    assert reader.get("f" * 40) == record("f" * 40)


def test_removed_records_are_gone_wherever_they_lay(place, records):
    records.pack("run", KEYS)
    records.put(record("f" * 40))
    records.remove([*KEYS[2:], "f" * 40])
    assert records.listed() == Records(place).listed() == KEYS[:2]
    records.remove(KEYS)
    assert records.listed() == []
    assert place.names("packs") == []


def test_list_of_a_pack_that_is_known_is_not_looked_through_again(place, records, monkeypatch):
    records.pack("run", KEYS)
    looked = []
    namelist = zipfile.ZipFile.namelist
    monkeypatch.setattr(zipfile.ZipFile, "namelist", lambda archive: (looked.append(1), namelist(archive))[1])
    reader = Records(place)
    assert reader.listed() == reader.listed() == KEYS
    assert len(looked) == 1
    more = [f"{n:040x}" for n in range(100, 100 + PACKED_FROM)]
    for key in more:
        records.put(record(key))
    records.pack("another", more)
    looked.clear()
    assert reader.listed() == KEYS + more
    assert len(looked) == 1
    place.remove("packs/run.zip")
    assert reader.listed() == more


def test_altered_pack_is_noticed_and_discarded(place, records):
    records.pack("run", KEYS)
    data = place.get("packs/run.zip")
    for at in range(0, len(data), 97):
        place.put("packs/run.zip", data[:at] + bytes([data[at] ^ 4]) + data[at + 1 :])
        reopened = Records(place)
        sound = {r.key for r in reopened.all()}
        assert all(r == record(r.key) for r in reopened.all())
        assert reopened.damaged() or sound == set(KEYS)
    place.put("packs/run.zip", b"PK")
    reopened = Records(place)
    assert reopened.damaged() == ["packs/run.zip"]
    reopened.discard_damaged()
    assert place.names("packs") == []


def test_pack_of_somebody_else_is_none(place):
    place.put("packs/x.zip", packed({f"{KEYS[0]}.json": sealed({"key": KEYS[0]}), "../../x": b"", "b.json": b"{}"}))
    assert Records(place).listed() == KEYS[:1]
    assert Records(place).get(KEYS[0]) is None


def pack_of(place, compression, files):
    with zipfile.ZipFile(out := io.BytesIO(), "w", compression) as archive:
        for key, data in files.items():
            archive.writestr(f"{key}.json", data)
    place.put("packs/run.zip", out.getvalue())


def test_record_that_unpacks_to_more_than_any_has_is_damage_and_never_unpacked(place, monkeypatch):
    large = record(KEYS[0], params={"x": " " * RECORD_BYTES})
    pack_of(place, zipfile.ZIP_DEFLATED, {r.key: sealed(asdict(r)) for r in (large, record(KEYS[1]))})
    unpacked = []
    read = zipfile.ZipFile.read
    monkeypatch.setattr(zipfile.ZipFile, "read", lambda archive, file: (unpacked.append(file), read(archive, file))[1])
    reader = Records(place)
    assert [r.key for r in reader.all()] == [KEYS[1]]
    assert reader.damaged() == [f"packs/run.zip: {KEYS[0]}.json"]
    reader.discard_damaged()
    assert Records(place).listed() == [KEYS[1]]
    assert set(unpacked) == {f"{KEYS[1]}.json"}


def test_pack_that_unpacks_to_far_more_than_it_has_is_damage(place, monkeypatch):
    files = {key: sealed(asdict(record(key, params={"x": " " * 50_000}))) for key in KEYS}
    pack_of(place, zipfile.ZIP_DEFLATED, files)
    assert Records(place).listed() == KEYS
    monkeypatch.setattr(records_module, "UNPACKED_BYTES", 100_000)
    assert Records(place).damaged() == ["packs/run.zip"]
    pack_of(place, zipfile.ZIP_STORED, files)
    assert Records(place).damaged() == []


@pytest.mark.parametrize("compression", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_pack_that_is_compressed_in_another_way_is_damage(place, compression):
    pack_of(place, compression, {KEYS[0]: sealed(asdict(record(KEYS[0])))})
    assert Records(place).damaged() == ["packs/run.zip"]


@pytest.mark.parametrize("value", [{}, [], "", "μ", {"a": [1, 2.5, None, True]}, "x" * 1000])
def test_what_was_sealed_is_unsealed(value):
    assert unsealed(sealed(value)) == value


@pytest.mark.parametrize("data", [None, b"", b"{}", b"{", sealed(3)[:-1], sealed(3) + b" ", b"[" * 10_000])
def test_what_was_not_sealed_is_nothing(data):
    assert unsealed(data) is None


def test_no_altered_byte_of_what_was_sealed_goes_unnoticed():
    data = sealed({"fps": 25})
    for at in range(len(data)):
        for bit in range(8):
            assert unsealed(data[:at] + bytes([data[at] ^ 1 << bit]) + data[at + 1 :]) is None
