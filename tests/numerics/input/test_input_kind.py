"""What a path holds is told from what lies there."""

import numpy as np
import pytest
from ball_views import ball_masks, write_folder

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input.input_kind import input_kind

VOLUME = np.zeros((3, 3, 3))


def test_meshes_come_first_and_what_lies_beside_them_is_chosen_by_a_pattern(tmp_path):
    (tmp_path / "frame_0.ply").touch()
    for t in (10, 9):
        np.savez(tmp_path / f"volume_{t}.npz", field=VOLUME)
        np.savez(tmp_path / f"silhouettes_{t}.npz", silhouettes=ball_masks()[:, :9, :9])
    assert input_kind(str(tmp_path)) == ("meshes", [])
    kind, files = input_kind(str(tmp_path / "volume_*.npz"))
    assert (kind, [f.name for f in files]) == ("volumes", ["volume_9.npz", "volume_10.npz"])
    kind, files = input_kind(str(tmp_path / "silhouettes_*.npz"))
    assert (kind, [f.name for f in files]) == ("packed silhouettes", ["silhouettes_9.npz", "silhouettes_10.npz"])


def test_folder_of_folders_of_images_is_silhouettes(tmp_path):
    assert input_kind(str(write_folder(tmp_path / "walk", 1))) == ("silhouettes", [])


def test_folder_of_volumes_is_volumes(tmp_path):
    for t in range(2):
        np.save(tmp_path / f"{t}.npy", VOLUME)
    assert input_kind(str(tmp_path))[0] == "volumes"


def test_calibration_beside_packed_silhouettes_is_no_frame(tmp_path):
    np.savez(tmp_path / "cameras.npz", P=np.zeros((2, 3, 4)))
    np.savez(tmp_path / "a_0.npz", silhouettes=ball_masks())
    kind, files = input_kind(str(tmp_path))
    assert (kind, [f.name for f in files]) == ("packed silhouettes", ["a_0.npz"])


def test_one_file_is_told_by_its_arrays(tmp_path):
    np.savez(tmp_path / "a.npz", volume=VOLUME[None])
    np.savez(tmp_path / "b.npz", vertices=np.zeros((3, 3)))
    np.save(tmp_path / "c.npy", VOLUME[None])
    assert [input_kind(str(tmp_path / name))[0] for name in ("a.npz", "b.npz", "c.npy")] == [
        "packed volumes", "meshes", "packed volumes",
    ]  # fmt: skip


def test_images_without_camera_folders_are_refused_with_the_layout(tmp_path):
    (tmp_path / "cam_0_frame_0.png").touch()
    with pytest.raises(SourceError, match=r"no folder for each camera; silhouettes are CAMERA/FRAME.png"):
        input_kind(str(tmp_path))


def test_what_does_not_exist_is_left_to_the_reader_of_meshes(tmp_path):
    assert input_kind(str(tmp_path / "nothing")) == ("meshes", [])
