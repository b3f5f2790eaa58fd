"""Laws of identity: distinct values have distinct digests, equal ones the same in every process."""

import math
import struct
import subprocess
import sys
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetree.pipeline.identity.key import (
    array_digest,
    artifact_digest,
    combined_digest,
    digest,
    encoded,
    file_digest,
    node_key,
)
from kinetree.pipeline.identity.own_code import code_digest
from kinetree.schemas.array import Array, Artifact, Floats, Ints, Location
from kinetree.schemas.dims import VERTEX, XYZ
from kinetree.schemas.input.source import Source


class Cloud(Artifact):
    """Points, for digests that must never change."""

    points: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """Positions."""
    colour: Annotated[Ints, Array("int32", VERTEX)]
    """A number each."""
    name: str
    """A word."""
    path: Annotated[str, Location()] = ""
    """Where it lies."""


def cloud(**changes):
    held = {"points": np.arange(6.0).reshape(2, 3), "colour": np.array([1, 2], dtype=np.int32), "name": "two"}
    return Cloud(**{**held, **changes})


plain = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=4) | st.binary(max_size=4),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=8,
)


def told_apart(value):
    """The value with its types, so that 1, 1.0 and True differ; −0.0 differs from 0.0 as their bytes do."""
    if isinstance(value, dict):
        return ("dict", tuple(sorted((k, told_apart(v)) for k, v in value.items())))
    if isinstance(value, list):
        return ("list", tuple(told_apart(v) for v in value))
    if isinstance(value, float):
        return ("float", struct.pack(">d", value))
    return (type(value).__name__, repr(value))


# ── values ──────────────────────────────────────────────────────────────────────────────────────────────────────────

# Pinned with Python 3.11 and numpy 2.4. A change here changes every key there is: say so in the changelog.
PINNED = {
    "none": (None, "d1be4f73c1aa7653a45c1f0d86f9085fcf213703"),
    "true": (True, "ad9b992f7245d62400a4082826b875c56c4e4663"),
    "one": (1, "30cc508a14cb570428faf44097235c48355ea19f"),
    "text one": ("1", "26d96973ff14fc75d893f98220cb83520d586cb7"),
    "float one": (1.0, "da6ab7720b1cf16c6fba3e09f6278cb1991b3a1e"),
    "nan": (math.nan, "d9cdb39681e213d26035f609572bd698fa4c8245"),
    "bytes": (b"\x00\xff", "21085fa86dee6f0519e67a5dff45c2c02f64460d"),
    "nested": ({"b": [1, "2", None], "a": {"μ": -0.0}}, "640c50b60c6450b5ed0ee3cb2ee1c588485cd324"),
}


@pytest.mark.parametrize("name", PINNED)
def test_digests_of_values_never_change(name):
    value, expected = PINNED[name]
    assert digest(value) == expected


def test_digests_of_arrays_never_change():
    assert array_digest(np.arange(6, dtype=np.int32).reshape(2, 3)) == "8a10483c1821bad9be538f46fa79100cf9322b72"
    assert array_digest(np.array([[0.5, -0.0, np.nan]])) == "6940affca9105429213392ff4c24584a9cabac1b"
    assert array_digest(np.zeros((0, 3))) == "a269acc13579c4d54acd768843b4f17f295f0b6f"
    assert array_digest(np.array(True)) == "7fa4ec01ffbc7c15b69ae328c5d07d89b0cddc84"


def test_digest_of_an_artifact_never_changes():
    assert artifact_digest(cloud()) == "77e0db92421dd996d082501473b6b78aa63fe09c"


def test_key_of_a_node_never_changes():
    found = node_key("mesh", "c0de", {"merge": 1e-7, "component_share": 0.05}, [["source", "one", ["ab"], None]])
    assert found == "39051419cc51f42efdab6d944145eeaa5475bb47"


def test_digest_of_a_file_is_blake2b_of_its_bytes(tmp_path):
    (tmp_path / "a").write_bytes(b"ply\n")
    # printf 'ply\n' | b2sum -l 160
    assert file_digest(tmp_path / "a") == "08758c3ad0939c31a2ef774102e09ebedc674608"


@given(plain, plain)
def test_distinct_values_have_distinct_digests(a, b):
    assert (digest(a) == digest(b)) == (told_apart(a) == told_apart(b))


def test_values_that_look_alike_differ():
    alike = [1, "1", 1.0, True, [1], [[1]], {"1": 1}, b"1", "True", None, "None", [], {}, "", b"", 0, 0.0, -0.0, False, "nan"]
    assert len({digest(value) for value in alike}) == len(alike)


def test_no_number_has_the_encoding_of_nan():
    bits = [b"nan     ", b"\x7f\xf0" + bytes(6), b"\xff\xf0" + bytes(6), b"\x7f\xef" + b"\xff" * 6]
    assert digest(math.nan) not in {digest(struct.unpack(">d", b)[0]) for b in bits}


def test_every_nan_is_the_same():
    other = struct.unpack(">d", b"\xff\xf8\x00\x00\x00\x00\x00\x01")[0]
    assert digest(other) == digest(math.nan)


@given(st.lists(st.text(max_size=3), max_size=4), st.lists(st.text(max_size=3), max_size=4))
def test_texts_do_not_run_into_each_other(a, b):
    assert (digest(a) == digest(b)) == (a == b)
    assert (digest([a, b]) == digest([[*a, *b], []])) == (not b)


@given(st.dictionaries(st.text(max_size=4), st.integers(), max_size=5), st.randoms())
def test_order_of_keys_is_irrelevant(mapping, random):
    names = random.sample(list(mapping), len(mapping))
    assert digest({name: mapping[name] for name in names}) == digest(mapping)


@pytest.mark.parametrize("value", [object(), {1, 2}, np.float64(1.0), np.int32(1), 1j, range(3), type, lambda: 1])
def test_values_without_canonical_bytes_are_refused(value):
    with pytest.raises(TypeError, match="no canonical encoding for"):
        digest([value])


def test_an_encoding_stands_for_its_value():
    value = {"p": [1, 2.5, None], "q": {"r": "s"}}
    assert digest([encoded(value), 1]) == digest([value, 1]) != digest([bytes(encoded(value)), 1])
    assert node_key("a", "c", encoded(value), []) == node_key("a", "c", value, [])


def test_keys_that_are_no_texts_are_refused():
    with pytest.raises(TypeError, match="mapping keys must be strings to have a canonical order, got 1"):
        digest({1: "a", "1": "b"})


def test_digests_are_the_same_in_another_process_with_another_hash_seed():
    code = (
        "from kinetree.pipeline.identity.key import digest;"
        "from kinetree.pipeline.identity.own_code import code_digest;"
        " print(digest({'b': 1.5, 'a': [1]}), code_digest('kinetree.schemas.input.mesh', 'Mesh'))"
    )
    seed = "1" if sys.flags.hash_randomization else "2"
    env = {"PYTHONHASHSEED": seed}
    told = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True)
    assert told.stdout == f"{digest({'a': [1], 'b': 1.5})} {code_digest('kinetree.schemas.input.mesh', 'Mesh')}\n"


# ── arrays and artifacts ────────────────────────────────────────────────────────────────────────────────────────────


def test_arrays_that_differ_in_dtype_shape_or_bytes_differ():
    a = np.arange(6, dtype=np.int32)
    others = [a.reshape(2, 3), a.reshape(3, 2), a.astype(np.int64), a.astype(np.uint32), a.astype(np.float32), a + 1, a[:5]]
    assert len({array_digest(x) for x in [a, *others]}) == len(others) + 1


def test_layout_in_memory_is_no_part_of_an_array():
    a = np.arange(12.0).reshape(3, 4)
    padded = np.zeros((3, 8))
    padded[:, ::2] = a
    same = [np.asfortranarray(a), padded[:, ::2], a.astype(">f8"), a[::-1][::-1]]
    assert {array_digest(x) for x in same} == {array_digest(a)}


def test_arrays_swapped_between_fields_differ():
    values = {"name": "two", "path": ""}
    one, other = combined_digest(Cloud, values, {"a": "1", "b": "2"}), combined_digest(Cloud, values, {"a": "2", "b": "1"})
    assert one != other


def test_where_bytes_lie_is_no_part_of_an_artifact():
    assert artifact_digest(cloud(path="/here")) == artifact_digest(cloud(path="/there"))
    assert artifact_digest(cloud(name="three")) != artifact_digest(cloud())


def test_frame_is_its_bytes_and_not_its_name_or_its_place_in_a_file():
    one = Source(content="ab", path="/x/a.ply")
    assert artifact_digest(one) == artifact_digest(Source(content="ab", path="/y/b.ply"))
    assert artifact_digest(one) != artifact_digest(Source(content="cd", path="/x/a.ply"))


def test_version_of_a_schema_is_part_of_its_artifacts(monkeypatch):
    before = artifact_digest(cloud())
    monkeypatch.setattr(Cloud, "version", 2)
    assert artifact_digest(cloud()) != before


def test_everything_that_decides_a_result_is_in_a_nodes_key():
    keys = [
        node_key("a", "c", {"p": 1}, [["x", "one", ["d"], None]]),
        node_key("b", "c", {"p": 1}, [["x", "one", ["d"], None]]),
        node_key("a", "d", {"p": 1}, [["x", "one", ["d"], None]]),
        node_key("a", "c", {"p": 2}, [["x", "one", ["d"], None]]),
        node_key("a", "c", {"q": 1}, [["x", "one", ["d"], None]]),
        node_key("a", "c", {"p": 1}, [["y", "one", ["d"], None]]),
        node_key("a", "c", {"p": 1}, [["x", "tuple", ["d"], None]]),
        node_key("a", "c", {"p": 1}, [["x", "one", ["e"], None]]),
        node_key("a", "c", {"p": 1}, [["x", "mapping", ["d"], [1]]]),
        node_key("a", "c", {"p": 1}, [["x", "mapping", ["d"], [2]]]),
        node_key("a", "c", {"p": 1}, []),
        node_key("a", "c", {"p": 1}, [], [1]),
        node_key("a", "c", {"p": 1}, [], [1, 2]),
        node_key("a", "c", {"p": 1}, [["index", 1]]),
        node_key("a", "c", {"p": 1}, [], []),
    ]
    assert len(set(keys)) == len(keys)
