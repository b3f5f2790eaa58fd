"""Arrays of the store are what zarr reads of them, and what is altered is found."""

import json

import numpy as np
import pytest
import zarr
from hypothesis import given
from hypothesis import strategies as st
from zarr.core.buffer import default_buffer_prototype
from zarr.storage import MemoryStore

from kinetree.pipeline import groups
from kinetree.pipeline.chunks import as_written
from kinetree.pipeline.groups import decoded, group_files
from kinetree.schemas.array import Array
from kinetree.schemas.dims import Dim

DTYPES = ("bool", "uint8", "int16", "int32", "int64", "float32", "float64")


def written(array):
    """The files of an array as the store writes them."""
    spec = Array(str(array.dtype), *(Dim(f"d{n}") for n in range(array.ndim)))
    files = group_files({}, {"x": array}, {"x": spec})
    return {path.removeprefix("x/"): data for path, data in files.items() if path.startswith("x/")}, spec


def by_zarr(files):
    buffer = default_buffer_prototype().buffer
    store = MemoryStore({path: buffer.from_bytes(data) for path, data in files.items()})
    return np.asarray(zarr.open_array(store=store, mode="r", zarr_format=3)[...])


def read(files):
    return as_written(json.loads(files["zarr.json"]), files)


@given(st.lists(st.integers(1, 5), max_size=3), st.sampled_from(DTYPES), st.integers(1, 60), st.integers(0, 99))
def test_an_array_is_read_as_it_was_written_and_as_zarr_reads_it(shape, dtype, chunk_bytes, seed):
    array = np.random.default_rng(seed).integers(0, 2 if dtype == "bool" else 100, shape).astype(dtype)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(groups, "CHUNK_BYTES", chunk_bytes)
        files, _ = written(array)
    found = read(files)
    assert found is not None
    assert (found.dtype, found.shape) == (array.dtype, array.shape)
    np.testing.assert_array_equal(found, array)
    np.testing.assert_array_equal(found, by_zarr(files))


def test_the_store_reads_what_it_wrote_without_zarr(monkeypatch):
    files, spec = written(np.arange(12.0).reshape(4, 3))
    monkeypatch.setattr(groups, "_read", lambda _: pytest.fail("zarr was asked"))
    np.testing.assert_array_equal(decoded(files, spec), np.arange(12.0).reshape(4, 3))


@pytest.mark.parametrize("change", [{"codecs": ["bytes"]}, {"codecs": [{"name": "transpose"}]}, {"chunk_key_encoding": None}])
def test_what_is_written_in_another_way_is_left_to_zarr(change):
    files, _ = written(np.arange(3.0))
    assert as_written({**json.loads(files["zarr.json"]), **change}, files) is None


@pytest.mark.parametrize("altered", [b"", b"\x00" * 17, None])
def test_altered_bytes_are_no_array(altered):
    files, _ = written(np.arange(3.0))
    other, _ = written(np.arange(4.0))
    with pytest.raises((ValueError, RuntimeError)):
        read({**files, "c/0": other["c/0"] if altered is None else altered})
