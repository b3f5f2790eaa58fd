"""Draco is unpacked apart: whatever a file does to its reader, this process goes on and has words for it."""

import sys

import numpy as np
import pytest

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input import draco

DracoPy = pytest.importorskip("DracoPy", reason="pip install 'kinetree[draco]' brings it")


def grid(n):
    """A flat sheet of n × n vertices."""
    corners = np.arange(n * n, dtype=np.uint32).reshape(n, n)
    quads = np.stack([corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]], axis=-1).reshape(-1, 4)
    V = np.stack([*np.meshgrid(np.arange(n), np.arange(n)), np.zeros((n, n))], axis=-1).reshape(-1, 3).astype(np.float32)
    return V, np.vstack([quads[:, :3], quads[:, [0, 2, 3]]])


def instead(monkeypatch, statement):
    """DracoPy does something else than decoding."""
    monkeypatch.setattr(draco, "_UNPACK", draco._UNPACK.replace("mesh = DracoPy.decode(sys.stdin.buffer.read())", statement))


def test_faces_that_take_no_bits_are_unpacked():
    V, F = grid(150)
    raw = DracoPy.encode(V, F, quantization_bits=1, compression_level=10)
    X, G = draco.unpacked(raw)
    assert (len(G), X.shape[1]) == (len(F), 3)
    assert len(raw) < G.nbytes / 40


def test_a_point_cloud_has_no_faces():
    X, G = draco.unpacked(DracoPy.encode(grid(5)[0]))
    assert (len(X), len(G)) == (25, 0)


@pytest.mark.parametrize(
    "does",
    ["bytearray(2**33)", "exec('while True: pass')", "import os; os.abort()"],
    ids=["memory", "time", "death"],
)
def test_what_a_file_does_to_its_reader_ends_there(monkeypatch, does):
    monkeypatch.setattr(draco, "MOST_SECONDS", 1)
    instead(monkeypatch, does)
    with pytest.raises(MeshError, match="its 5 bytes are not unpacked within 4 GB and 1 s; the file is damaged"):
        draco.unpacked(b"DRACO")


def test_what_unpacks_to_more_than_is_held_here_is_refused(monkeypatch):
    V, F = grid(50)
    raw = DracoPy.encode(V, F, quantization_bits=8)
    size = sum(len(array) * 12 for array in (V, F))
    monkeypatch.setattr(draco, "MOST_BYTES", size - 1)
    with pytest.raises(
        MeshError, match=f"its {len(raw)} bytes unpack to {size} bytes, more than {size - 1}; the file is damaged"
    ):
        draco.unpacked(raw)
    monkeypatch.setattr(draco, "MOST_BYTES", size)
    assert len(draco.unpacked(raw)[1]) == len(F)


def test_a_file_cut_short_or_with_altered_counts_is_refused():
    raw = DracoPy.encode(*grid(3), quantization_bits=8)
    for damaged in (raw[:4], raw[:12], raw[: len(raw) // 2], raw[:7] + b"\xff\xff\xff\xff\xff" + raw[12:], b""):
        with pytest.raises(MeshError, match=r"cannot be read as DRC \(DracoPy\.FileTypeException: .*\); the file is damaged"):
            draco.unpacked(damaged)


def test_without_its_reader_a_file_is_refused_with_what_brings_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    with pytest.raises(MeshError, match=r"pip install 'kinetree\[draco\]'"):
        draco.unpacked(b"DRACO")
