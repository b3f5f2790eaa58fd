"""Laws of a glTF's arrays: numbers as they lie in the bytes, whatever their kind and stride, and nothing beyond them."""

import numpy as np
import pytest
from numerics.input.animated_glbs import Made

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input.gltf import Gltf


def held(made, index):
    return Gltf.of(made.raw()).array(index)


@pytest.mark.parametrize("dtype", ["<f4", "<u1", "<u2", "<u4", "<i2"])
def test_numbers_of_every_kind_are_read(dtype):
    made = Made()
    values = np.arange(12).reshape(4, 3).astype(dtype)
    index = made.add(values)
    np.testing.assert_array_equal(held(made, index), values)


def test_normalized_whole_numbers_lie_within_one():
    made = Made()
    bytes_, shorts = (
        made.add(np.array([0, 128, 255], np.uint8), normalized=True),
        made.add(np.int16([-32768, 32767]), normalized=True),
    )
    np.testing.assert_allclose(held(made, bytes_), [0, 128 / 255, 1])
    np.testing.assert_allclose(held(made, shorts), [-1, 1])


def test_rows_may_lie_apart_and_matrices_are_columns_first():
    made = Made()
    index = made.add(np.arange(12, dtype=np.float32).reshape(4, 3))
    made.document["bufferViews"][-1]["byteStride"] = 24
    made.document["accessors"][index]["count"] = 2
    np.testing.assert_array_equal(held(made, index), [[0, 1, 2], [6, 7, 8]])
    matrix = np.arange(16, dtype=np.float32)
    np.testing.assert_array_equal(held(made, made.add(matrix.reshape(1, 16)))[0], matrix.reshape(4, 4).T)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"count": 99}, "runs to byte"),
        ({"count": -1}, "a count or an offset is"),
        ({"byteOffset": 10**6}, "runs to byte"),
        ({"bufferView": 77}, "names bufferViews 77, but there are"),
        ({"type": "VEC9"}, "no known or of too large a layout"),
        ({"count": 10**9}, "no known or of too large a layout"),
    ],
)
def test_what_is_not_there_is_refused(changes, told):
    made = Made()
    made.document["accessors"][0] |= changes
    with pytest.raises(SourceError, match=told):
        held(made, 0)


def test_data_outside_the_file_is_not_opened():
    made = Made()
    raw = made.raw()
    assert b'"byteLength"' in raw
    made.document["buffers"][0]["uri"] = "/etc/passwd"
    graph = Gltf(made.document, b"")
    with pytest.raises(SourceError, match="keeps its data outside itself, in '/etc/passwd'"):
        graph.array(0)
    with pytest.raises(SourceError, match="no complete binary glTF"):
        Gltf.of(raw[:-8])
