"""Laws of the output folder: a file that no run has left there stays, and what a run left is its own."""

import shutil

import pytest

from kinetree.errors import StoreError
from kinetree.pipeline.output.output import RUN_JSON
from kinetree.pipeline.output.ownership import MARKER, Owned
from kinetree.pipeline.output.session import UNRECORDED
from kinetree.pipeline.storage.place import Folder


def test_a_folder_that_is_not_there_is_all_ours(tmp_path):
    Owned.of(tmp_path / "deep" / "out").claim(["a.json", "parts/1.ply", "parts/2.ply"])
    assert Owned.of(tmp_path / "deep" / "out").names == {"a.json", "parts"}


def test_what_is_listed_may_be_replaced_and_nothing_else(tmp_path):
    Owned.of(tmp_path).claim(["a.json"])
    (tmp_path / "a.json").write_text("altered")
    (tmp_path / "b.json").write_text("mine")
    (tmp_path / "parts").mkdir()
    (tmp_path / "link").symlink_to("nowhere")
    Owned.of(tmp_path).claim(["a.json", "c.json"])
    for path in ("b.json", "parts/1.ply", "link"):
        with pytest.raises(StoreError, match=f"no run has left {path.partition('/')[0]} there"):
            Owned.of(tmp_path).claim(["a.json", "d.json", path])
    assert Owned.of(tmp_path).names == {"a.json", "c.json"}, "what was refused is not listed"


@pytest.mark.parametrize("path", ["/tmp/x", "../x", "parts/../../x", ""])
def test_what_does_not_lie_in_the_folder_is_never_claimed(tmp_path, path):
    (tmp_path / MARKER).write_text('{"files": ["", "..", "parts"]}')
    with pytest.raises(StoreError, match="does not lie in it"):
        Owned.of(tmp_path).claim(["a.json", path])


def test_files_are_listed_before_they_are_written(tmp_path):
    owned = Owned.of(tmp_path)
    owned.claim(["a.json"])
    (tmp_path / "a.json").write_text("written by a run that was killed then")
    Owned.of(tmp_path).claim(["a.json"])


def test_two_runs_into_one_folder_at_once_know_each_others_files(tmp_path):
    first, second = Owned.of(tmp_path), Owned.of(tmp_path)
    first.claim(["a.json"])
    (tmp_path / "a.json").write_text("of the first run")
    second.claim(["a.json", "b.json"])
    (tmp_path / "b.json").write_text("of the second run")
    first.claim(["b.json"])
    assert Owned.of(tmp_path).names == {"a.json", "b.json"}


def test_what_is_foreign_is_named_as_a_list(tmp_path):
    for name in ("a.json", "b.json", "c.json"):
        (tmp_path / name).write_text("mine")
    with pytest.raises(StoreError, match=r"no run has left a\.json, b\.json and c\.json there"):
        Owned.of(tmp_path).claim(["a.json", "b.json", "c.json"])


def test_output_folder_that_was_copied_without_its_list_is_ours(toys):
    toys.write(1)
    first = toys.pipeline()
    first.run()
    (toys.output / MARKER).unlink()
    assert first.run()["status"] == "done"
    assert {RUN_JSON, "config.yaml"} <= (Owned.of(toys.output).names or set())


@pytest.mark.parametrize("name", ["config.yaml", "run.json"])
def test_run_into_a_folder_of_somebody_else_replaces_nothing(toys, name):
    toys.write(1)
    there = toys.pipeline()
    shutil.rmtree(toys.output, ignore_errors=True)
    toys.output.mkdir(parents=True)
    (toys.output / name).write_text("{}")
    with pytest.raises(StoreError, match=f"no run has left {name} there"):
        there.run()
    assert [path.name for path in toys.output.iterdir()] == [name]
    assert (toys.output / name).read_text() == "{}"


def test_store_that_cannot_be_written_serves_a_run_that_has_nothing_to_compute(toys, tmp_path, monkeypatch):
    toys.write(1, 2)
    toys.run(store=str(tmp_path / "store"))
    put = Folder.put

    def refuse(place, path, data):
        if place.url == str(tmp_path / "store"):
            raise StoreError(f"store {place.url}: cannot write {path}: Read-only file system")
        put(place, path, data)

    monkeypatch.setattr(Folder, "put", refuse)
    toys.output = tmp_path / "another"
    before = sorted((tmp_path / "store").rglob("*"))
    account = toys.run(store=str(tmp_path / "store")).told
    assert account["status"] == "done"
    assert account["notes"] == [UNRECORDED]
    assert (toys.output / RUN_JSON).is_file()
    assert sorted((tmp_path / "store").rglob("*")) == before
    toys.write(3, start=2)
    with pytest.raises(StoreError, match="Read-only"):
        toys.run(store=str(tmp_path / "store"))


def test_output_folder_that_is_a_link_to_nothing_is_named(toys):
    toys.write(1)
    there = toys.pipeline()
    shutil.rmtree(toys.output, ignore_errors=True)
    toys.output.symlink_to("nowhere")
    with pytest.raises(StoreError, match=f"{toys.output.name} is a link to nowhere, which is not there; make that folder or"):
        there.run()
    assert toys.output.is_symlink()
