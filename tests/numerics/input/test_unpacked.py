"""Files of any size: none fills the memory, is read for minutes or starts another program."""

import bz2
import gzip
import io
import os
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

from kinetree.errors import HullError, MeshError, SourceError
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store
from kinetree.tasks.numerics.input import volumes
from kinetree.tasks.numerics.input.animated import read_animated
from kinetree.tasks.numerics.input.calibration import read_calibration
from kinetree.tasks.numerics.input.formats import MOST_BYTES, read_mesh
from kinetree.tasks.numerics.input.silhouettes import _image
from kinetree.tasks.numerics.input.unpacked import bomb, unpacks_beyond
from kinetree.tasks.numerics.input.volumes import read_volume, read_volumes

GIB = 2**30


def holes(path, size=20 * GIB, head=b""):
    """A file of that size of which the disk holds the first bytes alone."""
    path.write_bytes(head)
    os.truncate(path, size)
    return path


def zeros(path, key, shape):
    """An npz with an array of zeros, packed a thousandfold and never whole in memory."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive, archive.open(f"{key}.npy", "w") as file:
        np.lib.format.write_array_header_1_0(file, {"descr": "|u1", "fortran_order": False, "shape": shape})
        for _ in range(-(-int(np.prod(shape)) // 2**24)):
            file.write(bytes(2**24))
    return path


@pytest.mark.parametrize("name", ["huge.ply", "huge.obj", "huge.drc"])
def test_mesh_larger_than_any_is_refused_unread(tmp_path, name):
    with pytest.raises(MeshError, match=rf"{name}: {20 * GIB} bytes; more than {MOST_BYTES} are not read of one frame"):
        read_mesh(holes(tmp_path / name))


def test_file_larger_than_any_frame_has_no_digest(tmp_path):
    files = Files.of(Store.at(str(tmp_path / "store")))
    (tmp_path / "small.ply").write_bytes(b"ply")
    small, huge = files.digests([tmp_path / "small.ply", holes(tmp_path / "huge.ply")], MOST_BYTES)
    assert (small.startswith("unreadable"), huge) == (False, f"unreadable: more than {MOST_BYTES} bytes")


@pytest.mark.parametrize(
    ("head", "told"),
    [(b"", "no complete binary glTF"), (b"glTF" + struct.pack("<II", 2, 2**32 - 1), "4294967295 bytes; more than")],
)
def test_animation_larger_than_any_is_refused_unread(tmp_path, head, told):
    with pytest.raises(SourceError, match=rf"huge\.glb: {told}"):
        read_animated(holes(tmp_path / "huge.glb", head=head))


def test_mask_larger_than_any_is_refused_unread(tmp_path):
    with pytest.raises(HullError, match=r"huge\.png: 21474836480 bytes; more than"):
        _image(holes(tmp_path / "huge.png"))


def test_mask_of_another_kind_than_its_name_says_starts_no_program(tmp_path, monkeypatch):
    bin_ = tmp_path / "bin"
    bin_.mkdir()
    (bin_ / "gs").write_text(f"#!/bin/sh\ntouch {tmp_path / 'started'}\n")
    (bin_ / "gs").chmod(0o755)
    monkeypatch.setenv("PATH", f"{bin_}{os.pathsep}{os.environ['PATH']}")
    (tmp_path / "mask.png").write_bytes(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\nshowpage\n")
    with pytest.raises(HullError, match=r"mask\.png: cannot be read as an image"):
        _image(tmp_path / "mask.png")
    assert not (tmp_path / "started").exists()


def test_archives_of_volumes_that_are_bombs_are_refused(tmp_path, monkeypatch):
    assert volumes._MOST_DENSE == 2**31
    monkeypatch.setattr(volumes, "_MOST_DENSE", 10**6)
    path = zeros(tmp_path / "bomb.npz", "field", (3, 128, 128, 128))
    for read in (read_volume, read_volumes):
        with pytest.raises((HullError, SourceError), match=r"field: \d+ bytes would unpack to \d+; expected at most 100 times"):
            read(path)


def test_archive_of_cameras_that_is_a_bomb_is_refused(tmp_path):
    path = zeros(tmp_path / "calibration.npz", "P", (8 * 10**6, 3, 4))
    with pytest.raises(SourceError, match=r"P: \d+ bytes would unpack to \d+"):
        read_calibration([path])


@pytest.mark.parametrize(("encoding", "pack"), [("gzip", gzip.compress), ("bzip2", bz2.compress)])
def test_nrrd_that_unpacks_to_more_than_it_says_is_refused(tmp_path, encoding, pack):
    head = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: {encoding}\n\n".encode()
    (tmp_path / "bomb.nrrd").write_bytes(head + pack(bytes(2**26)))
    with pytest.raises(HullError, match=r"bomb\.nrrd: unpacks to more than 512 bytes"):
        read_volume(tmp_path / "bomb.nrrd")
    (tmp_path / "fine.nrrd").write_bytes(head + pack(bytes(range(64))))
    assert read_volume(tmp_path / "fine.nrrd").values.ravel(order="F").tolist() == list(range(64))


@pytest.mark.parametrize(("encoding", "pack"), [("gzip", gzip.compress), ("bzip2", bz2.compress)])
@pytest.mark.parametrize("size", [0, 1, 2**20, 2**20 + 1, 5 * 2**20])
def test_what_a_file_unpacks_to_is_counted_to_the_byte(encoding, pack, size):
    packed = pack(np.random.default_rng(0).integers(0, 4, size, dtype=np.uint8).tobytes())
    for most, is_beyond in ((size, False), (size - 1, True)):
        assert unpacks_beyond(io.BytesIO(packed), encoding, len(packed), most) is is_beyond


def test_little_and_loosely_packed_bytes_are_no_bomb():
    assert bomb(stored=1, unpacked=2**20) == ""
    assert bomb(stored=2**30, unpacked=2**35) == ""
    assert "1024 bytes would unpack to 1073741824" in bomb(stored=2**10, unpacked=2**30)
    assert bomb(stored=2**10, unpacked=2**30, allowed=2**31) == ""


def test_scratch_files_have_holes(tmp_path: Path) -> None:
    assert holes(tmp_path / "f").stat().st_blocks * 512 < 2**20
