"""The same volume in every format is the same grid; what is none is refused before it takes memory."""

import struct

import nrrd
import numpy as np
import pytest
import tifffile

from kinetree.errors import HullError, SourceError
from kinetree.tasks.numerics.input.npz import npz_shapes
from kinetree.tasks.numerics.input.volumes import Volumes, read_volume, read_volumes

VALUES = np.random.default_rng(0).normal(size=(4, 5, 6)).astype(np.float32)
ORIGIN, STEP = np.array([1.0, -2.0, 3.0]), np.array([0.5, 0.25, 2.0])


@pytest.mark.parametrize("suffix", ["npz", "npy", "nrrd", "tif"])
def test_every_format_gives_the_same_numbers_in_the_order_x_y_z(tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    if suffix == "npz":
        np.savez(path, field=VALUES)
    elif suffix == "npy":
        np.save(path, VALUES)
    elif suffix == "nrrd":
        nrrd.write(str(path), VALUES, index_order="F")
    else:
        tifffile.imwrite(path, VALUES.transpose(), photometric="minisblack")
    grid = read_volume(path)
    np.testing.assert_array_equal(grid.values, VALUES)
    np.testing.assert_array_equal(grid.origin, 0)
    np.testing.assert_array_equal(grid.spacing, 1)


def test_npz_is_placed_by_origin_and_voxel(tmp_path):
    np.savez(tmp_path / "a.npz", field=VALUES, origin=ORIGIN, voxel=0.5, band=2.0)
    grid = read_volume(tmp_path / "a.npz")
    np.testing.assert_array_equal(grid.origin, ORIGIN)
    np.testing.assert_array_equal(grid.spacing, 0.5)


def test_nrrd_is_placed_by_its_directions_and_a_negative_one_turns_its_axis(tmp_path):
    header = {"space": "left-posterior-superior", "space directions": np.diag(STEP * [1, -1, 1]), "space origin": ORIGIN}
    nrrd.write(str(tmp_path / "a.nrrd"), VALUES, header, index_order="F")
    grid = read_volume(tmp_path / "a.nrrd")
    np.testing.assert_array_equal(grid.values, VALUES[:, ::-1])
    np.testing.assert_array_equal(grid.spacing, STEP)
    np.testing.assert_array_equal(grid.origin, ORIGIN - [0, 4 * 0.25, 0])


def test_turned_nrrd_and_data_in_another_file_are_refused(tmp_path):
    turned = [[1, 1, 0], [-1, 1, 0], [0, 0, 1]]
    header = {"space": "left-posterior-superior", "space directions": turned, "space origin": ORIGIN}
    nrrd.write(str(tmp_path / "a.nrrd"), VALUES, header, index_order="F")
    with pytest.raises(HullError, match="are not along the axes; resample"):
        read_volume(tmp_path / "a.nrrd")
    nrrd.write(str(tmp_path / "b.nhdr"), VALUES, index_order="F")
    (tmp_path / "b.nhdr").rename(tmp_path / "b.nrrd")
    with pytest.raises(HullError, match="keeps its data in another file"):
        read_volume(tmp_path / "b.nrrd")


@pytest.mark.parametrize(
    ("held", "words"),
    [
        ({"field": VALUES[0]}, r"numbers \(x, y, z\) with at least 2"),
        ({"field": VALUES[:1]}, "with at least 2 along every axis"),
        ({"field": VALUES.astype(complex)}, "complex64|complex128"),
        ({"field": np.where(VALUES > 0, VALUES, np.nan)}, "values are NaN or infinite"),
        ({"other": VALUES}, "no array field or volume or values; there are other"),
        ({"field": VALUES, "voxel": -1.0}, "one or three lengths are needed"),
        ({"field": VALUES, "origin": [0.0, 1.0]}, "three numbers"),
        ({"field": np.array([{}], dtype=object)}, "cannot be read as a volume"),
    ],
)
def test_what_is_no_volume_is_refused(tmp_path, held, words):
    np.savez(tmp_path / "a.npz", **held)
    with pytest.raises(HullError, match=words):
        read_volume(tmp_path / "a.npz")


def test_files_that_are_something_else_are_refused(tmp_path):
    for suffix in ("npz", "npy", "nrrd", "tif"):
        (tmp_path / f"a.{suffix}").write_bytes(b"not a volume")
        with pytest.raises(HullError, match=f"a.{suffix}: cannot be read as a volume"):
            read_volume(tmp_path / f"a.{suffix}")
    with pytest.raises(HullError, match=r".vol is not read as a volume; .npy"):
        read_volume(tmp_path / "a.vol")


def test_claimed_size_is_refused_before_memory_is_taken(tmp_path):
    for path in (tmp_path / "a.npy", tmp_path / "a.nrrd"):
        if path.suffix == ".npy":
            np.lib.format.open_memmap(path, mode="w+", dtype=np.uint8, shape=(1100, 1100, 1100)).flush()
        else:
            path.write_text("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 99999 99999 99999\nencoding: raw\n\n")
        with pytest.raises(HullError, match="voxels is larger than"):
            read_volume(path)
        path.unlink()


def test_packed_volumes_are_read_frame_by_frame(tmp_path):
    packed = np.stack([VALUES, VALUES + 1])
    np.save(tmp_path / "a.npy", packed)
    np.savez(tmp_path / "b.npz", volume=packed, voxel=STEP, origin=ORIGIN)
    assert npz_shapes(tmp_path / "b.npz")["volume"] == (2, 4, 5, 6)
    for path, step in ((tmp_path / "a.npy", 1.0), (tmp_path / "b.npz", STEP)):
        volumes = read_volumes(path)
        assert len(volumes) == 2
        np.testing.assert_array_equal(volumes.grid(1).values, VALUES + 1)
        np.testing.assert_array_equal(volumes.grid(1).spacing, np.broadcast_to(step, 3))


def test_packed_array_that_holds_no_frames_of_volumes_is_refused(tmp_path):
    np.save(tmp_path / "a.npy", VALUES)
    with pytest.raises(SourceError, match=r"volumes of all frames are numbers \(frame, x, y, z\)"):
        read_volumes(tmp_path / "a.npy")
    with pytest.raises(SourceError, match="have more than"):
        Volumes.of(np.broadcast_to(np.float32(0), (2, 2000, 2000, 2000)), {}, "a")
    (tmp_path / "b.npz").write_bytes(b"PK")
    with pytest.raises(SourceError, match=r"cannot be read as .npz"):
        npz_shapes(tmp_path / "b.npz")


def test_tiff_whose_pages_go_round_in_a_circle_is_refused(tmp_path):
    path = tmp_path / "frame.tif"
    tifffile.imwrite(path, np.zeros((2, 3, 4), np.uint8), photometric="minisblack", metadata=None)
    with tifffile.TiffFile(path) as file:
        first = file.pages[0].offset
        last = file.pages[1].offset
    raw = bytearray(path.read_bytes())
    tags = int.from_bytes(raw[last : last + 2], "little")
    raw[last + 2 + 12 * tags : last + 6 + 12 * tags] = first.to_bytes(4, "little")
    path.write_bytes(raw)
    with pytest.raises(HullError, match=r"frame\.tif: its pages follow each other in a circle; the file is damaged"):
        read_volume(path)


def test_tiff_that_claims_more_strips_than_it_lists_is_refused_at_once(tmp_path):
    path = tmp_path / "frame.tif"
    tifffile.imwrite(path, np.zeros((2, 2, 2), np.uint8), photometric="minisblack", metadata=None)
    with tifffile.TiffFile(path) as file:
        at = file.pages[0].tags["ImageLength"].valueoffset
    raw = bytearray(path.read_bytes())
    raw[at : at + 4] = struct.pack("<I", 2**28)
    path.write_bytes(raw)
    with pytest.raises(HullError, match=r"page 0 claims 134217728 strips or tiles and lists 1; the file is damaged"):
        read_volume(path)
