"""Laws of the memory of files: settled files are not read again, changed ones always, and no memory can make a wrong digest."""

import json
import os

import pytest

from kinetree.pipeline.identity.key import file_digest
from kinetree.pipeline.storage import files as remembering
from kinetree.pipeline.storage.files import MEMORY, Files
from kinetree.pipeline.storage.sealed import sealed, unsealed
from kinetree.pipeline.storage.store import Store

LONG_AGO = 1_000_000_000


@pytest.fixture
def store(tmp_path):
    created = Store.at(tmp_path / "store")
    created.create()
    return created


@pytest.fixture
def read(monkeypatch):
    """The names of the files whose bytes were read."""
    names = []

    def watched(path):
        names.append(path.name)
        return file_digest(path)

    monkeypatch.setattr(remembering, "file_digest", watched)
    return names


@pytest.fixture
def settled(tmp_path, monkeypatch):
    """Writes a file that counts as settled: the clock stands an hour after whatever happened to it."""
    import time

    now = time.time() + 3600
    monkeypatch.setattr(remembering.time, "time", lambda: now)

    def write(name, data=b"one"):
        path = tmp_path / "frames" / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)
        return path

    return write


def digests(store, *paths):
    files = Files.of(store)
    computed = files.digests(paths)
    files.save()
    return computed


def test_digests_come_in_the_order_of_the_files(store, settled):
    paths = [settled(f"{n}.ply", bytes([n])) for n in range(40)]
    assert digests(store, *paths) == [file_digest(p) for p in paths]


def test_settled_file_is_read_once(store, settled, read):
    path = settled("a.ply")
    assert digests(store, path) == digests(store, path)
    assert read == ["a.ply"]


def test_file_changed_a_moment_ago_is_read_again(store, tmp_path, read):
    path = tmp_path / "a.ply"
    path.write_bytes(b"one")
    digests(store, path)
    digests(store, path)
    assert read == ["a.ply", "a.ply"]


@pytest.mark.parametrize("keep", ["nothing", "modification time"])
def test_changed_file_is_noticed_even_where_its_time_and_size_are_kept(store, settled, keep):
    path = settled("a.ply", b"one")
    os.utime(path, ns=(LONG_AGO, LONG_AGO))
    before = digests(store, path)
    path.write_bytes(b"two")
    if keep == "modification time":
        os.utime(path, ns=(LONG_AGO, LONG_AGO))  # the time of the last change of the inode cannot be set back
    assert digests(store, path) == [file_digest(path)] != before


def test_replaced_file_is_noticed(store, settled):
    path, other = settled("a.ply", b"one"), settled("b.ply", b"two")
    before = digests(store, path)
    other.replace(path)
    assert digests(store, path) != before


def test_file_that_changes_while_it_is_read_is_not_remembered(store, settled, monkeypatch, read):
    path = settled("a.ply")

    def racing(path):
        content = file_digest(path)
        path.write_bytes(b"more")
        return content

    monkeypatch.setattr(remembering, "file_digest", racing)
    first = digests(store, path)
    monkeypatch.setattr(remembering, "file_digest", file_digest)
    assert digests(store, path) == [file_digest(path)] != first


def test_unreadable_file_is_told_and_tried_again(store, settled, monkeypatch):
    path = settled("a.ply")

    def refuse(path):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(remembering, "file_digest", refuse)
    assert digests(store, path) == ["unreadable: Input/output error"]
    monkeypatch.setattr(remembering, "file_digest", file_digest)
    assert digests(store, path) == [file_digest(path)]


def test_missing_file_is_told(store, tmp_path):
    assert digests(store, tmp_path / "none") == ["unreadable: No such file or directory"]


def test_parts_of_a_file_and_its_bytes_are_remembered_apart(store, settled):
    path = settled("a.npz")
    files = Files.of(store)
    assert files.parts(path, "npz", lambda _: ["x", "y"]) == ["x", "y"]
    assert files.digests([path]) == [file_digest(path)]
    files.save()
    again = Files.of(store)
    assert again.parts(path, "npz", lambda _: pytest.fail("read again")) == ["x", "y"]
    assert again.parts(path, "zarr", lambda _: ["z"]) == ["z"]


def test_folder_changes_with_any_file_in_it(store, settled, tmp_path):
    folder = settled("zarr.json").parent
    settled("c", b"1")
    files = Files.of(store)
    assert files.parts(folder, "zarr", lambda _: ["first"]) == ["first"]
    assert files.parts(folder, "zarr", lambda _: ["second"]) == ["first"]
    settled("c", b"2")
    assert files.parts(folder, "zarr", lambda _: ["third"]) == ["third"]


@pytest.mark.parametrize(
    "memory", ["", "{", "[]", "3", "null", '{"bytes:PATH": 3}', '{"bytes:PATH": []}', '{"bytes:PATH": [1]}']
)
def test_memory_may_be_lost_or_nonsense_at_any_time(store, settled, memory):
    path = settled("a.ply")
    store.place.put(MEMORY, memory.replace("PATH", str(path)).encode())
    assert digests(store, path) == [file_digest(path)]


def test_memory_that_is_sealed_and_nonsense_all_the_same_is_no_memory(store, settled):
    path = settled("a.ply")
    store.place.put(MEMORY, sealed({f"bytes:{path}": [3, "x"]}))
    assert digests(store, path) == [file_digest(path)]


def test_one_altered_digit_makes_the_store_forget_what_it_knew_of_a_file(store, settled):
    path = settled("a.npz")
    files = Files.of(store)
    assert files.parts(path, "npz", lambda _: ["25.0", "mm"]) == ["25.0", "mm"]
    files.save()
    known = store.place.get(MEMORY)
    store.place.put(MEMORY, known.replace(b"25.0", b"35.0"))
    assert store.place.get(MEMORY) != known
    assert Files.of(store).parts(path, "npz", lambda _: ["25.0", "read again"]) == ["25.0", "read again"]


def test_planning_without_a_store_makes_none(tmp_path, settled):
    store = Store.at(tmp_path / "new")
    assert digests(store, settled("a.ply"))
    assert not (tmp_path / "new").exists()


def test_memory_holds_digests_and_no_bytes(store, settled):
    path = settled("a.ply", b"secret of the file")
    digests(store, path)
    memory = unsealed(store.place.get(MEMORY))
    assert list(memory) == [f"bytes:{path}"]
    assert "secret" not in json.dumps(list(memory.values()))
