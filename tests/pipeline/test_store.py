"""Laws of the store: what was published is read back bit for bit, damage is noticed, strangers are refused."""

import errno
import os
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import numpy as np
import pytest
import zarr
from pydantic import create_model
from zarr.storage import ZipStore

from kinetree.errors import DamagedArtifactError, StoreError, StoreFullError, UnknownNodeError
from kinetree.pipeline.identity.key import artifact_digest
from kinetree.pipeline.storage import groups
from kinetree.pipeline.storage import store as stores
from kinetree.pipeline.storage.packed import packed
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.sealed import sealed
from kinetree.pipeline.storage.store import FORMAT, MARKER, Record, Store, artifact_path
from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints
from kinetree.schemas.dims import FRAME, VERTEX, XYZ


class Field(Artifact):
    """Every kind of field there is."""

    positions: Annotated[Floats, Array("float64", FRAME, VERTEX, XYZ, unit="length")]
    """Where."""
    holes: Annotated[Floats, Array("float64", VERTEX, unit="rad", finite=False)]
    """May be anything."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """A number each."""
    kept: Annotated[Bools, Array("bool", VERTEX)]
    """A flag each."""
    mean: Annotated[Floats, Array("float64", unit="area")]
    """One number."""
    words: tuple[str, ...]
    """Plain."""
    rate: float | None
    """Plain or nothing."""


def field(vertices=4, frames=2, **changes):
    rng = np.random.default_rng(7)
    values = {
        "positions": rng.normal(size=(frames, vertices, 3)),
        "holes": np.where(np.arange(vertices) % 2, np.nan, -np.inf),
        "label": np.arange(vertices, dtype=np.int32) - 1,
        "kept": np.arange(vertices) % 3 == 0,
        "mean": np.array(0.1),
        "words": ("a\nb", "[red]", "μ", ""),
        "rate": None,
    }
    return Field(**{**values, **changes})


def record(key, digest, size):
    return Record(key, "field", {}, digest, size, {}, {}, [], 0.5, 1, "here", "now")


def files_of(store, digest):
    """What lies in the zip of an artifact, by path."""
    with zipfile.ZipFile(Path(store.url) / artifact_path(digest)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def everything(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture
def store(tmp_path):
    created = Store.at(tmp_path / "store")
    created.create()
    return created


# ── publishing and reading ──────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("vertices", "frames"), [(4, 2), (0, 0), (0, 3), (1, 1), (1000, 1)])
def test_what_was_published_is_read_back_bit_for_bit(store, vertices, frames):
    artifact = field(vertices, frames)
    digest, _ = store.publish(artifact)
    back = store.read(Field, digest)
    assert back == artifact
    assert artifact_digest(back) == digest == artifact_digest(artifact)
    assert [(a.dtype, a.shape) for a in back.arrays().values()] == [(a.dtype, a.shape) for a in artifact.arrays().values()]


def test_large_arrays_lie_in_several_chunks_and_come_back(store, monkeypatch):
    monkeypatch.setattr(groups, "CHUNK_BYTES", 1024)
    artifact = field(vertices=100, frames=7)
    digest, _ = store.publish(artifact)
    assert len([name for name in files_of(store, digest) if name.startswith("positions/c/")]) == 7
    assert store.read(Field, digest) == artifact


def test_arrays_of_zeros_are_written_too_so_that_a_lost_chunk_is_told_from_an_empty_one(store):
    digest, _ = store.publish(field(positions=np.zeros((2, 4, 3)), kept=np.zeros(4, dtype=bool)))
    assert {"positions/c/0/0/0", "kept/c/0"} <= set(files_of(store, digest))
    assert not store.read(Field, digest).positions.any()


def test_artifact_is_one_file_that_zarr_reads_alone_with_dimension_names_and_units(store):
    digest, _ = store.publish(field())
    assert [p.name for p in (Path(store.url) / "artifacts").rglob("*") if p.is_file()] == [f"{digest}.zip"]
    group = zarr.open_group(ZipStore(Path(store.url) / artifact_path(digest), mode="r"), mode="r")
    assert group.metadata.zarr_format == 3
    assert group["positions"].metadata.dimension_names == ("frame", "vertex", "xyz")
    assert group["mean"].metadata.dimension_names in ((), None)
    assert {n: a.attrs["unit"] for n, a in group.arrays()} == {
        "positions": "length", "holes": "rad", "label": "1", "kept": "1", "mean": "area",
    }  # fmt: skip
    assert group.attrs["kinetree"]["schema"] == "Field"
    assert group.attrs["kinetree"]["values"] == {"words": ["a\nb", "[red]", "μ", ""], "rate": None}
    np.testing.assert_array_equal(group["positions"][...], field().positions)
    group.store.close()


def test_arrays_are_read_when_asked_for_and_once(store, monkeypatch):
    digest, _ = store.publish(field())
    back = store.read(Field, digest)
    asked = []
    monkeypatch.setattr(stores, "decoded", lambda files, spec: asked.append(spec.unit) or groups.decoded(files, spec))
    assert back.words == ("a\nb", "[red]", "μ", "")
    assert "not read yet" in repr(back)
    assert asked == []
    assert back.label is back.label
    assert asked == ["1"]
    with pytest.raises(ValueError, match="read-only"):
        back.label[0] = 3


def test_equal_artifacts_are_stored_once(store):
    first = store.publish(field())
    before = everything(Path(store.url))
    assert store.publish(field()) == first
    assert everything(Path(store.url)) == before


def test_artifacts_that_differ_in_one_bit_are_two(store):
    assert store.publish(field())[0] != store.publish(field(mean=np.nextafter(0.1, 1)))[0]
    assert store.publish(field(rate=1.0))[0] != store.publish(field())[0]


def test_reading_one_array_reads_no_other(store, monkeypatch):
    digest, size = store.publish(field(vertices=10_000, frames=20))
    read = []
    part, tail = Folder.part, Folder.tail

    def watched(method):
        def call(self, *asked):
            content = method(self, *asked)
            read.append(len(content[0] if isinstance(content, tuple) else content))
            return content

        return call

    monkeypatch.setattr(Folder, "part", watched(part))
    monkeypatch.setattr(Folder, "tail", watched(tail))
    assert store.read(Field, digest).label[3] == 2
    assert sum(read) < size / 20


def test_no_reader_meets_half_an_artifact(store, monkeypatch):
    artifact = field()
    digest, _ = store.publish(artifact)
    store.discard(digest)
    visible = []
    replace = Path.replace

    def watched(path, target):
        visible.append((Path(store.url) / artifact_path(digest)).exists())
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", watched)
    store.publish(artifact)
    assert visible == [False]
    assert store.read(Field, digest) == artifact


def test_record_is_written_and_read_back(store):
    digest, size = store.publish(field())
    own = record("ab" * 20, digest, size)
    store.write(own)
    assert store.record("ab" * 20) == own
    assert list(store.records.all()) == [own]
    assert store.holds(own)
    assert size == (Path(store.url) / artifact_path(digest)).stat().st_size
    assert store.record("cd" * 20) is None


# ── damage ──────────────────────────────────────────────────────────────────────────────────────────────────────────


def damaged(store, path, change):
    """An artifact in whose zip one file was changed, with every checksum of the zip itself as it should be."""
    digest, size = store.publish(field())
    files = files_of(store, digest)
    files[path] = change(files[path])
    put_back(store, digest, files)
    return digest, size


def put_back(store, digest, files):
    whole = {name: data for name, data in files.items() if data is not None}
    (Path(store.url) / artifact_path(digest)).write_bytes(packed(whole))


def flip(data):
    return data[: len(data) // 2] + bytes([data[len(data) // 2] ^ 1]) + data[len(data) // 2 + 1 :]


def lost(data):
    return None


@pytest.mark.parametrize("change", [flip, lost, lambda data: b"", lambda data: data[:-3]])
@pytest.mark.parametrize("path", ["positions/c/0/0/0", "kept/c/0", "mean/c", "label/zarr.json"])
def test_lost_or_altered_arrays_are_noticed_on_reading(store, path, change):
    digest, _ = damaged(store, path, change)
    with pytest.raises(DamagedArtifactError) as noticed:
        store.read(Field, digest).arrays()
    assert noticed.value.digest == digest
    assert path.partition("/")[0] in noticed.value.what
    assert str(noticed.value).endswith("; it will be computed again")


@pytest.mark.parametrize("change", [lost, lambda data: b"{}", lambda data: b"[1]", lambda data: b"\xff"])
def test_lost_or_altered_metadata_is_noticed(store, change):
    digest, _ = damaged(store, "zarr.json", change)
    with pytest.raises(DamagedArtifactError, match=r"a file is missing|its metadata cannot be read"):
        store.read(Field, digest)


def test_altered_value_is_noticed(store):
    digest, _ = damaged(store, "zarr.json", lambda data: data.replace(b"[red]", b"[blue]"))
    with pytest.raises(DamagedArtifactError, match="its attributes were altered"):
        store.read(Field, digest)


@pytest.mark.parametrize(
    ("old", "new"), [(b'"length"', b'"degree"'), (b'"frame"', b'"angle"'), (b'"float64"', b'"uint64"'), (b"3", b"4")]
)
def test_altered_unit_dimension_dtype_or_shape_is_noticed(store, old, new):
    digest, _ = damaged(store, "positions/zarr.json", lambda data: data.replace(old, new))
    assert old in files_of(store, store.publish(field(rate=2.0))[0])["positions/zarr.json"]
    with pytest.raises(DamagedArtifactError, match="array positions"):
        store.group(Field, digest)


def test_every_byte_of_the_zip_is_checked_or_harmless(store):
    artifact = field(vertices=2, frames=1)
    digest, _ = store.publish(artifact)
    path = Path(store.url) / artifact_path(digest)
    data = path.read_bytes()
    noticed = 0
    for place in range(0, len(data), 7):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0x21]) + data[place + 1 :])
        try:
            assert store.read(Field, digest) == artifact
        except DamagedArtifactError:
            noticed += 1
    assert noticed > len(data) / 7 / 2


def test_array_swapped_for_another_valid_one_is_noticed(store):
    digest, _ = store.publish(field())
    other, _ = store.publish(field(label=np.arange(4, dtype=np.int32) + 5))
    put_back(store, digest, {**files_of(store, digest), "label/c/0": files_of(store, other)["label/c/0"]})
    with pytest.raises(DamagedArtifactError, match="array label was altered"):
        assert store.read(Field, digest).label is None


def test_artifact_of_another_schema_is_not_taken_for_this_one(store):
    class Other(Artifact):
        """Something else."""

    digest, _ = store.publish(Other())
    with pytest.raises(DamagedArtifactError, match="holds Other/1, not Field"):
        store.read(Field, digest)


def test_value_that_its_schema_refuses_is_damage(store):
    other = create_model("Field", __base__=Field, rate=(str, ...))
    digest, _ = store.publish(other(**{**field().plain(), **field().arrays(), "rate": "fast"}))
    with pytest.raises(DamagedArtifactError, match="its values are not those of its schema"):
        store.read(Field, digest)


@pytest.mark.parametrize("change", [Path.unlink, lambda f: f.write_bytes(f.read_bytes() + b"x")])
def test_record_holds_only_while_its_artifact_has_its_size(store, change):
    digest, size = store.publish(field())
    change(Path(store.url) / artifact_path(digest))
    assert not store.holds(record("ab" * 20, digest, size))


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "{}", '{"key": "' + "ab" * 20 + '"}'])
def test_unreadable_record_makes_nothing_fresh(store, text):
    store.place.put(f"records/{'ab' * 20}.json", text.encode())
    assert store.record("ab" * 20) is None
    assert list(store.records.all()) == []


@pytest.mark.parametrize("change", [{"artifact": "../../../victim"}, {"key": "cd" * 20}, {"bytes": "3"}, {"surplus": 1}])
def test_forged_record_is_not_believed(store, change):
    told = {**asdict(record("ab" * 20, "cd" * 20, 3)), **change}
    store.place.put(f"records/{'ab' * 20}.json", sealed(told))
    assert store.record("ab" * 20) is None


def test_published_again_mends_what_was_lost(store):
    artifact = field()
    digest, size = damaged(store, "positions/c/0/0/0", lost)
    store.publish(artifact)
    assert store.holds(record("ab" * 20, digest, size))
    assert store.read(Field, digest) == artifact


def test_published_again_mends_what_was_altered_at_equal_size(store):
    digest, size = damaged(store, "positions/c/0/0/0", flip)
    assert store.holds(record("ab" * 20, digest, size))
    store.publish(field())
    assert store.read(Field, digest) == field()


# ── what is and what is no store ────────────────────────────────────────────────────────────────────────────────────


def test_naming_a_store_writes_nothing(tmp_path):
    assert not Store.at(tmp_path / "new").exists
    assert not (tmp_path / "new").exists()


def test_folder_with_other_things_is_no_store(tmp_path):
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(StoreError) as refused:
        Store.at(tmp_path)
    assert str(refused.value) == (
        f"store {tmp_path}: this folder holds other things and is no kinetree store; name an empty or a new one"
    )
    assert everything(tmp_path) == {"thesis.tex": b"mine"}


def test_file_is_no_store(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(StoreError, match="this is a file; a store is a folder, name one with --store"):
        Store.at(tmp_path / "file")


@pytest.mark.parametrize("marker", ['{"format": "kinetree.store/1"}', "{}", "[]", "\x00", "", '"kinetree.store/2"'])
def test_store_of_another_format_is_refused_with_a_remedy(tmp_path, marker):
    (tmp_path / MARKER).write_text(marker)
    with pytest.raises(StoreError) as refused:
        Store.at(tmp_path)
    assert f"this version reads {FORMAT!r}; name another folder with --store" in str(refused.value)


@pytest.mark.parametrize("url", ["gs://x", "file:///tmp/x"])
def test_service_that_is_not_supported_is_refused(url):
    with pytest.raises(StoreError, match="is not supported; give a folder or s3://bucket/folder"):
        Store.at(url)


def test_store_whose_marker_was_removed_is_still_a_store(store):
    digest, _ = store.publish(field())
    (Path(store.url) / MARKER).unlink()
    again = Store.at(store.url)
    again.create()
    assert Store.at(store.url).exists
    assert again.read(Field, digest) == field()


def test_store_whose_first_writer_died_is_still_a_store(tmp_path):
    (tmp_path / "tmp").mkdir()
    (tmp_path / "tmp" / ".half").write_bytes(b"x")
    store = Store.at(tmp_path)
    store.create()
    assert Store.at(tmp_path).exists


# ── runs ────────────────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", ["nothing", "../records/ab", "../../etc/passwd", "", ".", "a/b", "\x1b[31m", "a\nb"])
def test_run_that_is_not_there_is_refused_by_name(store, name):
    store.place.put("records/ab.json", sealed({"nodes": {}}))
    with pytest.raises(UnknownNodeError) as refused:
        store.run(name)
    assert str(refused.value) == f"no run {name!r} in {store.url}; kinetree runs lists them"


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "{}", '{"nodes": 3}'])
def test_damaged_run_is_named_with_a_remedy(store, text):
    store.place.put("runs/one.json", text.encode())
    with pytest.raises(StoreError, match=r"runs/one\.json is damaged; kinetree verify --repair removes it"):
        store.run("one")
    assert store.runs() == []


def test_runs_are_listed_oldest_first(store):
    for name in ("2", "1", "3"):
        store.write_run(name, {"nodes": {}})
    store.place.put("runs/notes.txt", b"mine")
    assert store.run_names() == ["1", "2", "3"]


# ── full disk ───────────────────────────────────────────────────────────────────────────────────────────────────────


def test_full_disk_keeps_what_was_published(store, monkeypatch):
    digest, size = store.publish(field())
    store.write(record("ab" * 20, digest, size))
    before = everything(Path(store.url))
    write = Path.write_bytes

    def refuse(path, data):
        write(path, data[:1])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", refuse)
    with pytest.raises(StoreFullError, match="no space left"):
        store.publish(field(vertices=9))
    with pytest.raises(StoreFullError, match="no space left"):
        store.write(record("cd" * 20, digest, size))
    assert everything(Path(store.url)) == before


def test_runs_that_used_the_same_share_one_list_of_nodes(store):
    nodes = {f"points[{n}]": {"state": "ran", "key": "ab" * 20, "artifact": "cd" * 20} for n in range(9)}
    store.write_run("1", {"nodes": nodes})
    before = set(everything(Path(store.url)))
    store.write_run("2", {"nodes": {name: {**node, "state": "fresh"} for name, node in nodes.items()}})
    assert set(everything(Path(store.url))) - before == {"runs/2.json"}
    assert store.run("1")["nodes"] == nodes
    assert {node["state"] for node in store.run("2")["nodes"].values()} == {"fresh"}
