"""Laws of a zip of frames: the same meshes as the files', in natural order, and bounds before bytes are unpacked."""

import zipfile

import numpy as np
import pytest

from kinetree.errors import MeshError, SourceError
from kinetree.tasks.numerics.input import unpacked, zipped
from kinetree.tasks.numerics.input.animated import read_animated

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def off(scale):
    rows = [" ".join(map(str, v)) for v in V * scale] + ["3 " + " ".join(map(str, f)) for f in F]
    return "OFF\n4 4 0\n" + "\n".join(rows) + "\n"


@pytest.fixture
def archive(tmp_path):
    path = tmp_path / "walk.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for t in (10, 9, 1):
            file.writestr(f"walk/frame_{t}.off", off(t))
        file.writestr("walk/readme.txt", "not a frame")
        file.writestr("__MACOSX/walk/._frame_1.off", "not a mesh")
    return path


def test_members_are_the_frames_in_natural_order(archive):
    frames = read_animated(archive)
    assert [str(name) for name in frames.names] == ["walk/frame_1.off", "walk/frame_9.off", "walk/frame_10.off"]
    for t, scale in enumerate((1, 9, 10)):
        X, G = frames.mesh(t)
        np.testing.assert_array_equal(X, V * scale)
        np.testing.assert_array_equal(G, F)


def test_damaged_archives_and_members_are_refused_with_their_names(archive, tmp_path):
    raw = bytearray(archive.read_bytes())
    raw[60] ^= 0xFF  # within the first member's data
    archive.write_bytes(raw)
    with pytest.raises((SourceError, MeshError), match=r"walk\.zip.*frame_10\.off"):
        read_animated(archive).mesh(2)
    with zipfile.ZipFile(archive) as file:
        begin = file.getinfo("walk/frame_9.off").header_offset + 30 + len("walk/frame_9.off")
    for at in range(begin, begin + 20):
        damaged = bytearray(raw)
        damaged[at] ^= 0xFF
        archive.write_bytes(damaged)
        with pytest.raises((SourceError, MeshError), match=r"walk\.zip.*frame_9\.off"):
            read_animated(archive).mesh(1)
    (tmp_path / "none.zip").write_bytes(b"PK\x03\x04 cut short")
    with pytest.raises(SourceError, match=r"none\.zip: cannot be read as a zip"):
        read_animated(tmp_path / "none.zip")
    with zipfile.ZipFile(tmp_path / "empty.zip", "w") as file:
        file.writestr("readme.txt", "nothing")
    with pytest.raises(SourceError, match=r"no mesh among its files \(1 × \.txt\)"):
        read_animated(tmp_path / "empty.zip")


def test_bombs_are_refused_before_they_are_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr(unpacked, "UNPACKED_BYTES", 10**5)
    with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("frame_0.ply", b"\0" * 10**6)
    with pytest.raises(SourceError, match=r"frame_0\.ply: \d+ bytes would unpack to 1000000"):
        read_animated(tmp_path / "bomb.zip")
    monkeypatch.setattr(zipped, "MOST_BYTES", 10**6 - 1)
    with pytest.raises(SourceError, match=r"frame_0\.ply: 1000000 bytes; more than 999999 are no frame"):
        zipped.Zipped(tmp_path / "bomb.zip")


def test_names_that_lead_out_of_the_zip_are_refused_by_name(tmp_path):
    with zipfile.ZipFile(tmp_path / "out.zip", "w") as file:
        file.writestr("../../frame_0.ply", b"ply")
        file.writestr("frame_1.ply", b"ply")
    with pytest.raises(SourceError, match=r"out\.zip: the name '\.\./\.\./frame_0\.ply' leads out of the zip"):
        read_animated(tmp_path / "out.zip")
