"""Laws of a place: all or nothing, whatever fails on the way, and every refusal of the disk in words a user can act on."""

import builtins
import contextlib
import errno
import os
import subprocess
from pathlib import Path

import pytest

from kinetree.errors import StoreError, StoreFullError
from kinetree.pipeline.storage.place import Folder

bound = pytest.mark.skipif(os.geteuid() == 0, reason="permissions do not bind root")


@pytest.fixture
def place(tmp_path):
    return Folder(tmp_path / "store")


def sizes(place, path):
    return {name: told.size for name, told in place.listed(path).items()}


def everything(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def failing(monkeypatch, code, only=None):
    """Every write of a file fails as the system would, halfway."""
    write = Path.write_bytes

    def refuse(path, data):
        if only is None or path.name == only:
            write(path, data[: len(data) // 2])
            raise OSError(code, os.strerror(code), str(path))
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", refuse)


def test_what_was_put_is_got(place):
    place.put("a/b.json", b"one")
    assert place.get("a/b.json") == b"one"
    place.put("a/b.json", b"two")
    assert place.get("a/b.json") == b"two"
    assert (place.size("a/b.json"), place.names("a"), place.names("")) == (3, ["b.json"], ["a", "tmp"])
    assert place.names("tmp") == []


def test_where_nothing_is_nothing_is_found(place):
    assert place.get("a") is None
    assert place.size("a") is None
    assert place.names("a") == []
    assert place.listed("a") == {}
    assert place.modified("a") == 0
    place.remove("a")
    place.put("file", b"")
    assert place.get("file/below") is None
    assert place.names("file/below") == []
    assert place.get("") is None


def test_tree_is_put_whole(place):
    place.put_all("artifacts/ab/abc", {"zarr.json": b"{}", "x/c/0/0": b"1234"})
    assert sizes(place, "artifacts/ab/abc") == {"zarr.json": 2, "x/c/0/0": 4}
    assert place.names("tmp") == []


def test_tree_of_equal_sizes_stays_as_it_is(place):
    place.put_all("t", {"a": b"old"})
    before = (place.root / "t" / "a").stat().st_ino
    place.put_all("t", {"a": b"new"})
    assert (place.root / "t" / "a").stat().st_ino == before
    assert place.names("tmp") == []


@pytest.mark.parametrize("damage", ["missing", "cut"])
def test_damaged_tree_is_replaced(place, damage):
    place.put_all("t", {"a": b"one", "b": b"two"})
    (place.root / "t" / "b").unlink() if damage == "missing" else (place.root / "t" / "b").write_bytes(b"t")
    place.put_all("t", {"a": b"one", "b": b"two"})
    assert sizes(place, "t") == {"a": 3, "b": 3}


def test_removed_tree_and_file_are_gone(place):
    place.put_all("t", {"a/b": b"1"})
    place.put("f", b"2")
    place.remove("t")
    place.remove("f")
    assert everything(place.root) == {}


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT])
def test_full_disk_leaves_everything_as_it_was_and_says_what_to_do(place, monkeypatch, code):
    place.put("records/a", b"old")
    place.put_all("artifacts/t", {"x": b"old", "y": b"old"})
    before = everything(place.root)
    failing(monkeypatch, code)
    for write in (
        lambda: place.put("records/a", b"newer"),
        lambda: place.put("records/b", b"newer"),
        lambda: place.put_all("artifacts/u", {"x": b"newer", "y": b"newer"}),
    ):
        with pytest.raises(StoreFullError) as refused:
            write()
        assert str(refused.value).startswith(f"store {place.url}: no space left while writing ")
        assert "nothing stored is lost: free some space and run again" in str(refused.value)
    assert everything(place.root) == before


def test_tree_that_fails_at_its_last_file_is_not_there_at_all(place, monkeypatch):
    failing(monkeypatch, errno.ENOSPC, only="z")
    with pytest.raises(StoreFullError):
        place.put_all("t", {"a": b"1", "b/c": b"2", "z": b"3"})
    assert everything(place.root) == {}


@pytest.mark.parametrize("code", [errno.EACCES, errno.EROFS, errno.EIO])
def test_refused_write_names_store_file_and_remedy(place, monkeypatch, code):
    failing(monkeypatch, code)
    with pytest.raises(StoreError) as refused:
        place.put("records/a", b"new")
    assert not isinstance(refused.value, StoreFullError)
    told = f"store {place.url}: cannot write records/a: {os.strerror(code)}; check its permissions or name another folder"
    assert str(refused.value) == f"{told} (--output, --store)"


def test_refused_read_names_store_file_and_remedy(place, monkeypatch):
    place.put("records/a", b"x")

    def refuse(path, *_):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))

    monkeypatch.setattr(builtins, "open", refuse)
    monkeypatch.setattr(Path, "iterdir", refuse)
    with pytest.raises(StoreError, match=r"cannot read records/a: Permission denied; check its permissions"):
        place.get("records/a")
    with pytest.raises(StoreError, match=r"cannot list records: Permission denied; check its permissions"):
        place.names("records")


@bound
def test_folder_without_permission_is_refused(place):
    place.root.mkdir()
    place.root.chmod(0o500)
    with pytest.raises(StoreError, match="Permission denied"):
        place.put("a", b"1")
    place.root.chmod(0o700)


def test_file_where_the_folder_should_be_is_refused(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(StoreError, match="cannot write a: Not a directory"):
        Folder(tmp_path / "file" / "store").put("a", b"1")
    assert (tmp_path / "file").read_text() == "mine"


@pytest.fixture
def tiny(tmp_path):
    """A disk of 64 KiB."""
    folder = tmp_path / "tiny"
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", str(folder)], capture_output=True, text=True)
    if mounted.returncode:
        pytest.skip(f"a small disk cannot be mounted here: {mounted.stderr.strip()}")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_disk_that_is_truly_full_loses_nothing(tiny):
    place = Folder(tiny / "store")
    place.put_all("artifacts/a", {"x": b"1" * 20_000, "y": b"2" * 10_000})
    place.put("records/a", b"a")
    before = everything(place.root)
    with pytest.raises(StoreFullError):
        place.put_all("artifacts/b", {"x": b"1" * 20_000, "y": b"2" * 40_000})
    with pytest.raises(StoreFullError):
        place.put("records/b", b"3" * 60_000)
    assert everything(place.root) == before
    place.put("records/b", b"b")
    assert place.get("records/b") == b"b"


def test_listing_a_tree_that_shrinks_meanwhile_tells_what_is_left(place, monkeypatch):
    place.put_all("t", {"a": b"1", "b": b"22", "c/d": b"3"})
    scan = os.scandir

    @contextlib.contextmanager
    def shrinking(path):
        with scan(path) as entries:
            listed = list(entries)
        for name in ("b", "c/d"):
            (place.root / "t" / name).unlink(missing_ok=True)
        if (place.root / "t" / "c").exists():
            (place.root / "t" / "c").rmdir()
        yield listed

    monkeypatch.setattr(os, "scandir", shrinking)
    assert sizes(place, "t") == {"a": 1}


def test_listing_tells_size_and_time_of_everything_below(place):
    place.put_all("t", {"b": b"22", "a/c/d": b"3"})
    os.utime(place.root / "t" / "b", (1, 7))
    listed = place.listed("t")
    assert list(listed) == ["a/c/d", "b"]
    assert (listed["b"].size, listed["b"].modified) == (2, 7.0)


OUTSIDE = ["{above}/elsewhere", "../elsewhere", "a/../../elsewhere", "a/..", "a//b", "a/", ".", "", "a\0b"]


@pytest.mark.parametrize("path", OUTSIDE)
def test_what_does_not_lie_in_the_folder_is_neither_written_nor_removed(place, tmp_path, path):
    path = path.format(above=tmp_path)
    place.put("b", b"1")
    (tmp_path / "elsewhere").write_bytes(b"mine")
    before = everything(tmp_path)
    for change in (
        lambda: place.put(path, b"2"),
        lambda: place.put_all(path, {"x": b"2"}),
        lambda: place.put_all("tree", {"x": b"2", path: b"2"}),
        lambda: place.remove(path),
        lambda: place.remove_all([path]),
    ):
        with pytest.raises(StoreError, match=f"^store {place.url}: .* does not lie in it; nothing is written or removed"):
            change()
    assert everything(tmp_path) == before


@pytest.fixture
def linked(place, tmp_path):
    """A place with a folder that is a link to one outside."""
    (tmp_path / "mine" / "old").mkdir(parents=True)
    (tmp_path / "mine" / "old" / "x").write_bytes(b"mine")
    place.root.mkdir()
    (place.root / "link").symlink_to(tmp_path / "mine")
    return place


def test_nothing_is_written_or_removed_behind_a_link_that_leads_out_of_the_folder(linked, tmp_path):
    before = everything(tmp_path / "mine")
    for change in (
        lambda: linked.put("link/old/x", b"2"),
        lambda: linked.put_all("link/tree", {"x": b"2"}),
        lambda: linked.remove("link/old/x"),
        lambda: linked.remove("link/old"),
        lambda: linked.remove_all(["link/old/x"]),
    ):
        with pytest.raises(StoreError, match="'link/.*' does not lie in it, but behind a link that leads out; nothing"):
            change()
    assert everything(tmp_path / "mine") == before


def test_a_link_that_leads_out_of_the_folder_is_removed_and_not_what_it_leads_to(linked, tmp_path):
    linked.remove("link")
    assert linked.names("") == []
    assert everything(tmp_path / "mine") == {"old/x": b"mine"}


def test_nothing_is_listed_behind_a_link_that_leads_out_of_the_folder(linked):
    assert linked.listed("link") == linked.listed("link/old") == {}
    assert list(linked.listed("")) == ["link"]


def test_half_written_things_do_not_go_behind_a_link_that_leads_out_of_the_folder(place, tmp_path):
    (tmp_path / "mine").mkdir()
    place.root.mkdir()
    (place.root / "tmp").symlink_to(tmp_path / "mine")
    with pytest.raises(StoreError, match="tmp/.* does not lie in it"):
        place.put("a", b"1")
    assert list((tmp_path / "mine").iterdir()) == []


def test_folder_that_is_a_link_is_written_and_emptied_as_any_other(tmp_path):
    (tmp_path / "disk").mkdir()
    (tmp_path / "store").symlink_to("disk")
    place = Folder(tmp_path / "store")
    place.put("a/b", b"1")
    place.put_all("t", {"c/d": b"2"})
    assert sizes(place, "a") == {"b": 1}
    place.remove("t")
    place.remove("a/b")
    assert everything(tmp_path / "disk") == {}
