"""Masks are found by camera and number and read whatever their depth; what does not fit is named."""

import numpy as np
import pytest
from ball_views import RING, ball_masks, calibration, write_folder
from PIL import Image

from kinetree.errors import HullError, SourceError
from kinetree.tasks.numerics.input.silhouettes import camera_folders, mask_files, read_masks, read_packed_masks

KNOWN = calibration()


@pytest.fixture
def walk(tmp_path):
    return write_folder(tmp_path / "walk")


def read(walk, frame=0):
    return read_masks(mask_files(walk, KNOWN)[frame][1], KNOWN)


def test_what_is_written_is_found_and_read_back(walk):
    assert list(camera_folders(walk)) == list(KNOWN.names)
    assert [number for number, _ in mask_files(walk, KNOWN)] == [0, 1, 2]
    np.testing.assert_array_equal(read(walk, 1), ball_masks(0.9, (0.0, 0.0, 0.1)))


def test_images_of_one_moment_have_the_same_last_number_whatever_their_names(walk):
    (walk / "cam_03" / "frame_0001.png").rename(walk / "cam_03" / "take2_view_1.png")
    np.testing.assert_array_equal(read(walk, 1), ball_masks(0.9, (0.0, 0.0, 0.1)))


def test_frames_are_the_numbers_of_all_cameras_and_a_camera_may_lack_some(walk):
    (walk / "cam_03" / "frame_0001.png").rename(walk / "cam_03" / "frame_0010.png")
    files = dict(mask_files(walk, KNOWN))
    assert list(files) == [0, 1, 2, 10]
    assert [n for n, path in enumerate(files[1]) if path is None] == [3]
    assert [n for n, path in enumerate(files[10]) if path is not None] == [3]
    assert read(walk, 1)[3] is None


@pytest.mark.parametrize("mode", ["L", "1", "I;16", "RGB", "RGBA", "LA", "P"])
def test_depth_and_channels_of_a_mask_do_not_matter(walk, mode):
    path, mask = walk / "cam_00" / "frame_0000.png", ball_masks(0.9)[0]
    if mode == "I;16":
        image = Image.fromarray(mask.astype(np.uint16) * 900)
    else:
        image = Image.fromarray(mask.astype(np.uint8) * 255).convert("L" if mode == "P" else mode)
        image = image.convert("P") if mode == "P" else image
    image.save(path)
    np.testing.assert_array_equal(read(walk)[0], mask)


def test_mask_of_ones_is_a_mask(walk):
    Image.fromarray(ball_masks(0.9)[0].astype(np.uint8)).save(walk / "cam_00" / "frame_0000.png")
    np.testing.assert_array_equal(read(walk)[0], ball_masks(0.9)[0])


def test_empty_mask_is_empty(walk):
    Image.new("L", (200, 160)).save(walk / "cam_00" / "frame_0000.png")
    assert not read(walk)[0].any()


def test_mask_of_another_size_is_named(walk):
    Image.new("L", (100, 80), 255).save(walk / "cam_02" / "frame_0000.png")
    with pytest.raises(HullError, match=r"cam_02/frame_0000.png: 100 × 80 pixels, but camera cam_02 .* for 200 × 160"):
        read(walk)


def test_damaged_image_is_named(walk):
    path = walk / "cam_02" / "frame_0000.png"
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(HullError, match=r"cam_02/frame_0000.png: cannot be read as an image"):
        read(walk)


def test_image_of_absurd_size_is_refused_before_it_is_unpacked(walk):
    Image.new("1", (30_000, 30_000)).save(walk / "cam_02" / "frame_0000.png")
    with pytest.raises(HullError, match=r"cam_02/frame_0000.png: "):
        read(walk)


def test_cameras_without_folder_or_calibration_are_named(walk):
    (walk / "cam_04").rename(walk / "front")
    with pytest.raises(SourceError, match="has images of 15; no folder with images for cam_04; no calib.* front"):
        mask_files(walk, KNOWN)


def test_two_images_of_one_number_and_images_without_one_are_refused(walk):
    (walk / "cam_00" / "other_0002.png").write_bytes(b"")
    with pytest.raises(SourceError, match=r"frame_0002.png and other_0002.png are both of frame 2"):
        mask_files(walk, KNOWN)
    (walk / "cam_00" / "other_0002.png").rename(walk / "cam_00" / "background.png")
    with pytest.raises(SourceError, match=r"background.png: no number in its name"):
        mask_files(walk, KNOWN)


def test_packed_masks_are_read(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", silhouettes=ball_masks())
    np.testing.assert_array_equal(read_packed_masks(tmp_path / "a.npz", KNOWN), ball_masks())


@pytest.mark.parametrize(
    ("held", "words"),
    [
        ({"silhouettes": ball_masks()[:7]}, "silhouettes of 7 cameras, but the calibration has 15"),
        ({"silhouettes": ball_masks()[:, :99]}, r"200 × 99 pixels, but camera cam_00 is calibrated for 200 × 160"),
        ({"silhouettes": ball_masks()[0]}, r"numbers \(camera, row, column\) are needed"),
        ({"masks": ball_masks()}, "no array silhouettes can be read"),
        ({"silhouettes": np.array([{}], dtype=object)}, "no array silhouettes can be read"),
        ({"silhouettes": np.zeros((15, 9000, 9000), dtype=np.bool_)}, "unpacks to .* bytes, more than"),
    ],
)
def test_packed_masks_that_do_not_fit_are_refused(tmp_path, held, words):
    np.savez_compressed(tmp_path / "a.npz", **held)
    with pytest.raises(HullError, match=words):
        read_packed_masks(tmp_path / "a.npz", KNOWN)
    assert RING.size == (160, 200)
