"""Laws of kept code digests: they are those that would be computed, and what is kept of other code is never taken."""

import os

import pytest

from kinetree.pipeline.identity import own_code
from kinetree.pipeline.identity.code_cache import CodeCache
from kinetree.pipeline.identity.kept import FILES_KEPT
from kinetree.tasks.input.mesh import mesh

TEXTS = {"a.b": "def f(): return 1\n", "a.c": "X = 2\n"}
FOUND = ("0" * 40, {"a.b": "f:000000"})


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    own_code.forget_code()
    yield tmp_path / "kinetree" / "code"
    own_code.forget_code()


def cache_of(texts=TEXTS):
    cache = CodeCache.of(texts)
    cache.add("a.b:f", FOUND)
    cache.save()
    return cache


def test_what_was_kept_is_found_again():
    cache_of()
    assert CodeCache.of(dict(reversed(TEXTS.items()))).known == {"a.b:f": FOUND}


@pytest.mark.parametrize("texts", [{**TEXTS, "a.c": "X = 3\n"}, {**TEXTS, "a.d": ""}, {"a.b": TEXTS["a.b"]}, {}])
def test_other_code_finds_nothing(texts):
    cache_of()
    assert CodeCache.of(texts).known == {}


def test_every_altered_byte_of_a_kept_file_is_noticed(home):
    path = cache_of().path
    whole = path.read_bytes()
    for place in range(len(whole)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        assert CodeCache.of(TEXTS).known in ({}, {"a.b:f": FOUND})
    path.write_bytes(whole[:-9])
    assert CodeCache.of(TEXTS).known == {}


def test_a_place_that_cannot_be_written_is_no_failure(home, tmp_path):
    home.parent.mkdir(parents=True)
    home.write_text("not a folder")
    assert CodeCache.of(TEXTS).known == {}
    cache_of()
    assert CodeCache.of(TEXTS).known == {}


def test_old_files_go(home):
    for number in range(FILES_KEPT + 3):
        cache_of({**TEXTS, "a.e": f"{number}"})
    assert len([*home.glob("*.json")]) == FILES_KEPT


def test_a_file_that_is_used_stays(home):
    used = cache_of().path
    os.utime(used, (0, 0))
    for number in range(FILES_KEPT - 1):
        os.utime(cache_of({**TEXTS, "a.e": f"{number}"}).path, (number + 1, number + 1))
    assert CodeCache.of(TEXTS).known
    cache_of({**TEXTS, "a.e": "one more"})
    assert used.exists()


def test_kept_digests_are_those_that_are_computed(monkeypatch):
    computed = own_code.code_digest(mesh.module, mesh.name), own_code.code_parts(mesh.module, mesh.name)
    own_code.keep_code()
    own_code.forget_code()
    monkeypatch.setattr(own_code, "_computed", None)
    assert (own_code.code_digest(mesh.module, mesh.name), own_code.code_parts(mesh.module, mesh.name)) == computed


def test_code_of_another_package_is_not_kept(toys, home):
    toys.module  # noqa: B018 - its graph is made when it is imported
    assert not [name for path in home.glob("*.json") for name in (path.read_text(),) if toys.name in name]
