"""Laws of a glTF's arrays: numbers as they lie in the bytes, whatever their kind and stride, and nothing beyond them."""

import numpy as np
import pytest
from numerics.input.animated_glbs import GlbDraft

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input.gltf import Gltf


def read_array(glb, index):
    return Gltf.of(glb.raw()).array(index)


@pytest.mark.parametrize("dtype", ["<f4", "<u1", "<u2", "<u4", "<i2"])
def test_numbers_of_every_kind_are_read(dtype):
    glb = GlbDraft()
    values = np.arange(12).reshape(4, 3).astype(dtype)
    index = glb.add(values)
    np.testing.assert_array_equal(read_array(glb, index), values)


def test_normalized_whole_numbers_lie_within_one():
    glb = GlbDraft()
    bytes_, shorts = (
        glb.add(np.array([0, 128, 255], np.uint8), normalized=True),
        glb.add(np.int16([-32768, 32767]), normalized=True),
    )
    np.testing.assert_allclose(read_array(glb, bytes_), [0, 128 / 255, 1])
    np.testing.assert_allclose(read_array(glb, shorts), [-1, 1])


def test_rows_may_lie_apart_and_matrices_are_columns_first():
    glb = GlbDraft()
    index = glb.add(np.arange(12, dtype=np.float32).reshape(4, 3))
    glb.document["bufferViews"][-1]["byteStride"] = 24
    glb.document["accessors"][index]["count"] = 2
    np.testing.assert_array_equal(read_array(glb, index), [[0, 1, 2], [6, 7, 8]])
    matrix = np.arange(16, dtype=np.float32)
    np.testing.assert_array_equal(read_array(glb, glb.add(matrix.reshape(1, 16)))[0], matrix.reshape(4, 4).T)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"count": 99}, "runs to byte"),
        ({"count": -1}, "a count or an offset is"),
        ({"byteOffset": 10**6}, "runs to byte"),
        ({"bufferView": 77}, "names bufferViews 77, but there are"),
        ({"type": "VEC9"}, "no known or of too large a layout"),
        ({"count": 10**9}, "no known or of too large a layout"),
    ],
)
def test_what_is_not_there_is_refused(changes, words):
    glb = GlbDraft()
    glb.document["accessors"][0] |= changes
    with pytest.raises(SourceError, match=words):
        read_array(glb, 0)


def test_data_outside_the_file_is_not_opened():
    glb = GlbDraft()
    raw = glb.raw()
    assert b'"byteLength"' in raw
    glb.document["buffers"][0]["uri"] = "/etc/passwd"
    graph = Gltf(glb.document, b"")
    with pytest.raises(SourceError, match="keeps its data outside itself, in '/etc/passwd'"):
        graph.array(0)
    with pytest.raises(SourceError, match="no complete binary glTF"):
        Gltf.of(raw[:-8])
