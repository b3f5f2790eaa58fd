"""The user's files in a bucket: which there are, copies of them, what messages call them, how often the service is asked."""

import gc
from pathlib import Path
from typing import Annotated

import pytest

from kinetree.errors import InputError
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.remote import brought, copied, listed_files
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.array import Artifact, Location


class Where(Artifact):
    """What a task reads one of."""

    content: str
    path: Annotated[str, Location()]
    more: Annotated[tuple[str, ...], Location()] = ()


@pytest.fixture
def bucket(service):
    """The bucket's address, with a few objects in it."""
    place = Store.at(f"s3://{service.bucket}").place
    for name in ("top.txt", "in/a_1.txt", "in/a_2.txt", "in/b_1.txt", "in/.hidden", "in/deep/a_3.txt"):
        place.put(name, name.encode())
    return place


def names(where):
    return [address.rpartition("/")[2] for address in listed_files(where)]


def test_folder_pattern_and_address_are_found_as_on_a_disk(bucket):
    assert names(f"{bucket.url}/in/") == names(f"{bucket.url}/in") == ["a_1.txt", "a_2.txt", "b_1.txt"]
    assert names(bucket.url) == ["top.txt"]
    assert names(f"{bucket.url}/in/a_*.txt") == ["a_1.txt", "a_2.txt"]
    assert names(f"{bucket.url}/in/**/a_*.txt") == ["a_1.txt", "a_2.txt", "a_3.txt"]
    assert names(f"{bucket.url}/*/*_1.t?t") == ["a_1.txt", "b_1.txt"]
    assert names(f"{bucket.url}/in/a_2.txt") == ["a_2.txt"]
    assert next(iter(listed_files(f"{bucket.url}/in/a_*"))) == f"{bucket.url}/in/a_1.txt"


@pytest.mark.parametrize("where", ["none/", "in/a_9.txt", "in/c_*.txt"])
def test_where_nothing_is_that_is_said(bucket, where):
    with pytest.raises(InputError, match=r"there is nothing; a folder, a pattern or a file"):
        listed_files(f"{bucket.url}/{where}")


def test_copy_has_name_and_bytes_and_goes_with_its_last_user(bucket):
    with copied(f"{bucket.url}/in/a_1.txt") as first:
        assert (first.name, first.read_bytes()) == ("a_1.txt", b"in/a_1.txt")
        for n in range(8):  # more than are kept
            bucket.put(f"other/{n}", b"")
            with copied(f"{bucket.url}/other/{n}"):
                pass
        assert first.exists()
    gc.collect()
    assert not first.exists()


def test_copy_of_an_object_that_was_replaced_is_of_the_new_bytes(bucket):
    with copied(f"{bucket.url}/top.txt") as path:
        assert path.read_bytes() == b"top.txt"
    bucket.put("top.txt", b"newer!!")
    with copied(f"{bucket.url}/top.txt") as path:
        assert path.read_bytes() == b"newer!!"


def test_task_reads_copies_of_what_it_reads_one_of(bucket):
    one = Where(content="c", path=f"{bucket.url}/in/a_1.txt", more=("", f"{bucket.url}/in/b_1.txt", "/local"))
    here = Where(content="c", path="/local")
    with brought({"one": one, "many": (one,), "here": here, "params": 3}) as values:
        assert Path(values["one"].path).read_bytes() == b"in/a_1.txt"
        assert [Path(p).name for p in values["one"].more] == ["", "b_1.txt", "local"]
        assert (values["one"].content, values["many"], values["params"]) == ("c", (one,), 3)
        assert values["here"] is here


def test_what_is_wrong_with_a_copy_is_said_of_the_object(bucket):
    with pytest.raises(ValueError, match="^(.*)$") as refused, copied(f"{bucket.url}/in/a_1.txt") as path:
        raise ValueError(f"{path}: damaged")
    assert str(refused.value) == f"{bucket.url}/in/a_1.txt: damaged"


def test_object_that_is_gone_is_named(bucket):
    with pytest.raises(InputError, match=rf"^{bucket.url}/gone.txt: there is no such object"), copied(f"{bucket.url}/gone.txt"):
        pass


def test_unchanged_objects_are_listed_and_not_read_again(bucket, service, tmp_path):
    def digests():
        service.asked.clear()
        files = Files.of(store)
        uppercase = files.parts_of_each(files.addresses(f"{bucket.url}/in/"), "upper", lambda path: [path.read_text().upper()])
        files.save()
        return [parts[0] for parts in uppercase], {kind: n for kind, n in service.asked.items() if n}

    store = Store.at(tmp_path / "store")
    store.create()
    assert digests()[0] == ["IN/A_1.TXT", "IN/A_2.TXT", "IN/B_1.TXT"]
    assert digests() == (["IN/A_1.TXT", "IN/A_2.TXT", "IN/B_1.TXT"], {"LIST": 1})
    bucket.put("in/a_2.txt", b"other")
    assert digests() == (["IN/A_1.TXT", "OTHER", "IN/B_1.TXT"], {"LIST": 1, "HEAD": 1, "GET": 1})


@pytest.mark.parametrize("address", ["s3://key:word@bucket/in", "s3:///in", "s3://"])
def test_address_that_is_none_is_refused_and_not_repeated(address):
    for question in (lambda: listed_files(address), lambda: Store.at(address)):
        with pytest.raises(InputError, match="credentials in the environment") as refused:
            question()
        assert "word" not in str(refused.value)
