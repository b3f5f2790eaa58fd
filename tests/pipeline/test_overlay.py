"""A store that cannot be written: what is asked for is computed all the same, in memory, and nothing reaches the place."""

import errno
import os
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetree.errors import ReadOnlyStoreError, StoreError
from kinetree.pipeline.storage.overlay import Overlay
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.store import Store

PATHS = ("a", "b/c", "b/d", "b/e/f", "g/h")
FOLDERS = ("b", "b/e", "g")
data = st.binary(max_size=5)
change = st.tuples(st.sampled_from(PATHS), st.none() | data) | st.tuples(st.sampled_from(FOLDERS), st.none())
changes = st.lists(change, max_size=8)


def apply(place, changes):
    for path, data in changes:
        place.remove(path) if data is None else place.put(path, data)


def state(place):
    listed = {path: told.size for path, told in place.listed("").items()}
    read = place.get_all(PATHS)
    assert read == {path: place.get(path) for path in PATHS}
    assert {path: place.size(path) for path in PATHS} == {p: None if d is None else len(d) for p, d in read.items()}
    parts = [(place.tail(path, 2), place.part(path, 1, 3)) for path in PATHS]
    return listed, read, parts


def names(place):
    """What each folder holds, by the objects in it."""
    inside = {
        folder: [path.removeprefix(f"{folder}/") for path in PATHS if path.startswith(f"{folder}/")] for folder in FOLDERS
    }
    there = place.listed("")
    return {f: sorted({name.partition("/")[0] for name in held if f"{f}/{name}" in there}) for f, held in inside.items()}


@given(before=st.dictionaries(st.sampled_from(PATHS), data), after=changes)
def test_an_overlay_reads_like_a_folder_with_the_same_changes(tmp_path_factory, before, after):
    below, plain = (Folder(tmp_path_factory.mktemp("place")) for _ in range(2))
    apply(below, before.items())
    apply(plain, [*before.items(), *after])
    untouched = state(below)
    above = Overlay(below)
    apply(above, after)
    assert state(above) == state(plain)
    assert {folder: above.names(folder) for folder in FOLDERS} == names(plain)
    assert state(below) == untouched


def test_a_removed_folder_is_empty_and_may_be_filled_again(tmp_path):
    above = Overlay(Folder(tmp_path))
    above.put("tmp/sight/run", b"1")
    above.remove("tmp/sight")
    assert above.names("tmp") == []
    above.put("tmp/sight/run", b"2")
    assert (above.names("tmp"), above.get("tmp/sight/run")) == (["sight"], b"2")


def test_all_is_removed_below_the_root(tmp_path):
    below = Folder(tmp_path, beside="")
    below.put("a", b"1")
    below.put("b/c", b"2")
    above = Overlay(below)
    above.put("b/d", b"3")
    above.remove("")
    assert (above.listed(""), above.names(""), above.get("a"), above.get("b/d")) == ({}, [], None, None)
    above.remove("")
    above.put("a", b"4")
    assert (above.names(""), above.get("a"), below.get("a")) == (["a"], b"4", b"1")


def test_an_overlay_is_known_by_its_address_as_long_as_somebody_holds_it(tmp_path):
    store = Store.at(tmp_path).unwritten()
    url = store.url
    assert Store.at(url).place is store.place
    del store
    with pytest.raises(StoreError, match="memory:// is not supported"):
        Store.at(url)


@pytest.mark.parametrize(("code", "executor"), [(errno.EROFS, "processes"), (errno.EACCES, "threads"), (errno.ENOSPC, "sync")])
def test_one_task_is_computed_although_the_store_cannot_be_written(toys, monkeypatch, code, executor):
    toys.run()
    before = toys.stored()

    def refuse(_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(Folder, "_beside", refuse)
    pipeline = toys.pipeline(smooth={"grain": 100.0}, compute={"executor": executor, "workers": 1})
    there = pipeline.computed("total", also=("smooth",))
    assert there.artifact("total").value != toys.pipeline().artifact("total").value
    assert re.search(rf"cannot write .*{os.strerror(code)}|no space left", there.unkept)
    assert there.unkept.endswith("; computed in memory, nothing is kept")
    assert toys.stored() == before
    with pytest.raises(StoreError):
        pipeline.run()


def test_what_may_only_be_read_is_told_apart_from_what_is_broken(tmp_path, monkeypatch):
    for code, kind in ((errno.EROFS, ReadOnlyStoreError), (errno.EPERM, ReadOnlyStoreError), (errno.EIO, StoreError)):

        def refuse(_, code=code):
            raise OSError(code, os.strerror(code))

        monkeypatch.setattr(Folder, "_beside", refuse)
        with pytest.raises(StoreError, match="cannot write x") as refused:
            Folder(tmp_path).put("x", b"")
        assert type(refused.value) is kind
