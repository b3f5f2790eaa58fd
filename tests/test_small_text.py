"""Small texts of the user's: what they hold, or a sentence; never a hang, a full memory or a traceback."""

import os
from pathlib import Path

import pytest

from kinetree.errors import ConfigError, InputError
from kinetree.errors.small_text import DEPTH, VALUES, BoundedLoader, json_only, small_json, small_text, small_yaml

BOMB = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 12)
)


def test_a_text_is_read_with_or_without_a_byte_order_mark(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes("frühe".encode())
    (tmp_path / "b").write_bytes(b"\xef\xbb\xbf" + "frühe".encode())
    assert small_text(tmp_path / "a") == small_text(tmp_path / "b") == "frühe"


@pytest.mark.parametrize("limit", [4, 5])
def test_a_text_may_have_so_many_bytes_and_not_one_more(tmp_path: Path, limit: int) -> None:
    (tmp_path / "a").write_text("12345")
    if limit == 5:
        assert small_text(tmp_path / "a", largest=limit) == "12345"
    else:
        with pytest.raises(InputError, match="more than 4 bytes"):
            small_text(tmp_path / "a", largest=limit)


def test_what_is_no_regular_file_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "loop").symlink_to("loop")
    for path, what in ((tmp_path / "fifo", "regular"), (Path("/dev/zero"), "regular"), (tmp_path, "directory|regular")):
        with pytest.raises(ConfigError, match=what):
            small_text(path, ConfigError)
    for path in (tmp_path / "loop", tmp_path / "missing"):
        with pytest.raises(InputError, match="cannot be read"):
            small_text(path)
    with pytest.raises(InputError, match="not the path of a file: .*null"):
        small_text("a\0b")
    (tmp_path / "binary").write_bytes(b"ab\xff")
    with pytest.raises(InputError, match="byte 2 is 0xff"):
        small_text(tmp_path / "binary")


def test_a_file_larger_than_memory_is_not_read_whole(tmp_path: Path) -> None:
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(10**13)
    with pytest.raises(InputError, match="more than 1000 bytes"):
        small_text(tmp_path / "sparse", largest=1000)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("[" * 200_000, "nested too deeply"),
        (f"[{'9' * 400}]", "a number of 400 digits"),
        (f"[{'9' * 5000}]", "a number of 5000 digits"),
        ("{", "not JSON"),
    ],
)
def test_json_beyond_reason_is_refused(text: str, what: str) -> None:
    with pytest.raises(InputError, match=what):
        small_json(text, "a.json")


def test_json_of_ordinary_numbers_is_what_it_says() -> None:
    assert small_json('{"a": [1, -2, 1.5, 1e3, 12345678901234567890]}', "a.json") == {
        "a": [1, -2, 1.5, 1e3, 12345678901234567890]
    }


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (BOMB, f"written out are more than {VALUES} values"),
        ("a: &a\n  b: *a\n", "contains it"),
        ("&a\nextends: *a\n", "contains it"),
        ("[" * 5000 + "]" * 5000, "nested too deeply"),
        ("{a: " * 3000 + "1" + "}" * 3000, "nested too deeply"),
        ("a: !!timestamp foo\n", "not what its tag says"),
        ("a: !!timestamp 2001-99-99\n", "month must be in 1..12; put"),
        (f"a: {'9' * 5000}\n", "integer string conversion: value has 5000 digits; put"),
        ("a: !!int foo\n", "invalid literal"),
        ("a: !!python/object/apply:os.system ['x']\n", "could not determine a constructor"),
        ("a: \x07\n", "not valid YAML"),
    ],
)
def test_yaml_beyond_reason_is_refused(text: str, what: str) -> None:
    with pytest.raises(InputError, match=what):
        small_yaml(text, "a.yaml")


def test_yaml_of_ordinary_depth_with_aliases_is_what_it_says() -> None:
    text = "a: &a [1, 2]\nb: *a\nc:\n  <<: {d: 3}\n"
    assert small_yaml(text, "a.yaml", loader=BoundedLoader) == {"a": [1, 2], "b": [1, 2], "c": {"d": 3}}
    depth = DEPTH - 2
    assert str(small_yaml("[" * depth + "1" + "]" * depth, "a.yaml")).count("[") == depth


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("a: {b: 2001-01-01}", "a: b: datetime.date"),
        ("a: [1, {2: 3}]", "a: the key 2 is no text"),
        ("a: !!binary aGVsbG8=", "of type bytes"),
        ("a: !!set {b}", "of type set"),
    ],
)
def test_what_json_cannot_hold_is_named(text: str, what: str) -> None:
    with pytest.raises(InputError, match=what):
        json_only(small_yaml(text, "a.yaml"), "a.yaml")
    assert json_only({"a": [1, 2.5, None, True, "b"]}, "a.yaml") == {"a": [1, 2.5, None, True, "b"]}


@pytest.mark.parametrize("number", ["9" * 400, "-" + "9" * 400, "0x" + "f" * 300])
def test_whole_number_that_no_float_holds_is_refused_in_yaml(number):
    with pytest.raises(InputError, match="a.yaml, line 2: not valid YAML: a number of more than 308 digits"):
        small_yaml(f"a: 1\nb: {number}", "a.yaml")
    assert small_yaml(f"b: {10**307}", "a.yaml") == {"b": 10**307}
