"""What an npz holds by its names: the member that is held against the bound is the one that is read."""

import tracemalloc
import zipfile

import numpy as np
import pytest

from kinetree.errors import HullError, SourceError
from kinetree.tasks.numerics.input import unpacked
from kinetree.tasks.numerics.input.calibration import read_calibration
from kinetree.tasks.numerics.input.npz import npz_arrays, npz_shapes
from kinetree.tasks.numerics.input.source import read_npz
from kinetree.tasks.numerics.input.volumes import read_volume, read_volumes

VALUES = np.arange(8.0).reshape(2, 2, 2)


def write_member(path, name, array):
    """Adds an array to an archive under just this name."""
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive, archive.open(name, "w") as file:
        np.lib.format.write_array(file, array)
    return path


def test_arrays_are_read_by_their_names_as_many_as_there_are(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", field=VALUES, unit="mm", other=1)
    arrays = npz_arrays(tmp_path / "a.npz", ("field", "unit", "missing"), SourceError)
    assert sorted(arrays) == ["field", "unit"]
    np.testing.assert_array_equal(arrays["field"], VALUES)
    assert arrays["unit"] == "mm"


def test_member_without_a_suffix_is_not_read_in_place_of_the_array(tmp_path):
    path = write_member(write_member(tmp_path / "a.npz", "field", VALUES + 1), "field.npy", VALUES)
    np.testing.assert_array_equal(npz_arrays(path, ("field",), SourceError)["field"], VALUES)
    np.testing.assert_array_equal(read_volume(path).values, VALUES)
    packed = write_member(write_member(tmp_path / "b.npz", "field", VALUES[None] + 1), "field.npy", VALUES[None])
    np.testing.assert_array_equal(read_volumes(packed).grid(0).values, VALUES)


def test_member_without_a_suffix_is_no_array(tmp_path):
    faces = np.array([[0, 1, 2]], np.int32)
    arrays = {"faces.npy": faces, "vertex_offsets.npy": np.array([0, 3, 6]), "face_offsets.npy": np.array([0, 1])}
    for name, array in ({"vertices": np.zeros((6, 3))} | arrays).items():
        write_member(tmp_path / "walk.npz", name, array)
    with pytest.raises(SourceError, match=r"walk\.npz: no array vertices; there are face_offsets, faces, vertex_offsets"):
        read_npz(tmp_path / "walk.npz")
    with pytest.raises(SourceError, match=r"cameras\.npz: no array P \(camera, 3, 4\); there are size"):
        read_calibration([write_member(write_member(tmp_path / "cameras.npz", "P", VALUES), "size.npy", VALUES)])


def test_array_that_would_unpack_to_too_much_is_refused_in_the_words_of_its_reader(tmp_path, monkeypatch):
    np.savez_compressed(tmp_path / "a.npz", field=np.zeros(10**6))
    with pytest.raises(HullError, match=r"a\.npz: field: \d+ bytes would unpack to 8000128; expected at most 100"):
        npz_arrays(tmp_path / "a.npz", ("field",), HullError, allowed=8 * 10**6)
    assert npz_arrays(tmp_path / "a.npz", ("field",), HullError)["field"].nbytes == 8 * 10**6
    monkeypatch.setattr(unpacked, "UNPACKED_BYTES", 10**6)
    with pytest.raises(SourceError, match="would unpack to 8000128"):
        npz_arrays(tmp_path / "a.npz", ("field",), SourceError)


def test_member_that_is_no_array_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "walk.npz", "w") as archive:
        archive.writestr("vertices.npy", b"no array")
    with pytest.raises(SourceError, match=r"walk\.npz: cannot be read as \.npz \(ValueError: "):
        read_npz(tmp_path / "walk.npz")


def test_header_without_end_is_refused_and_not_unpacked(tmp_path):
    with zipfile.ZipFile(tmp_path / "walk.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("vertices.npy", b"\x93NUMPY\x02\x00" + (2**24).to_bytes(4, "little") + b" " * 2**24)
    tracemalloc.start()
    with pytest.raises(SourceError, match=r"walk\.npz: cannot be read as \.npz \(ValueError: EOF"):
        npz_shapes(tmp_path / "walk.npz")
    assert tracemalloc.get_traced_memory()[1] < 2**20
    tracemalloc.stop()
