"""Calibrations in every form are the same cameras, and what is wrong with one is said with its camera."""

import json

import numpy as np
import pytest
from ball_views import RING, calibration

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input.calibration import calibration_files, read_calibration, written_calibration

NAMES = [f"cam_{c:02d}" for c in range(15)]


def parted(P):
    """K, R and t of a matrix."""
    x, y, z = P[:, :3]
    K = np.array([[np.linalg.norm(np.cross(x, z)), 0, x @ z], [0, np.linalg.norm(np.cross(y, z)), y @ z], [0, 0, 1.0]])
    return K, np.linalg.solve(K, P[:, :3]), np.linalg.solve(K, P[:, 3])


def matrix(M):
    M = np.atleast_2d(M)
    return f"!!opencv-matrix\n   rows: {M.shape[0]}\n   cols: {M.shape[1]}\n   dt: d\n   data: {M.ravel().tolist()}\n"


@pytest.fixture
def read(tmp_path):
    """Writes the text of a file and reads it as a calibration."""

    def one(text, name="calibration.json"):
        (tmp_path / name).write_text(text if isinstance(text, str) else json.dumps(text))
        return read_calibration(calibration_files(tmp_path))

    return one


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("fps", -3, "fps is -3; one positive number of frames a second is needed, or null"),
        ("fps", float("nan"), "fps is nan"),
        ("fps", float("inf"), "fps is inf"),
        ("fps", 0, "fps is 0"),
        ("unit", 3, "unit is 3; the name of a unit of length is needed"),
        ("unit", {"m": 1}, "the name of a unit of length is needed"),
    ],
)
def test_rate_and_unit_that_are_none_are_refused(read, key, value, words):
    document = json.loads(written_calibration(calibration()))
    with pytest.raises(SourceError, match=rf"calibration\.json: .*{words}"):
        read({**document, key: value})


def test_a_size_that_no_image_has_is_refused_with_its_camera(read):
    document = json.loads(written_calibration(calibration()))
    document["cameras"][3]["size"] = [-5, 512]
    with pytest.raises(SourceError, match=r"camera cam_03: size is \[-5, 512\]; width and height"):
        read(document)


def test_what_is_written_is_read_back(read):
    before, after = calibration(), read(written_calibration(calibration()))
    assert (after.names, after.sizes, after.unit, after.fps) == (before.names, before.sizes, "m", 25.0)
    np.testing.assert_array_equal(after.P, before.P)


def test_matrices_rotations_and_rotation_vectors_say_the_same(read):
    from scipy.spatial.transform import Rotation

    K, R, t = parted(RING.P[3])
    for turn in (R.tolist(), Rotation.from_matrix(R).as_rotvec().tolist()):
        calibrated = read({"cameras": [{"K": K.tolist(), "R": turn, "t": t.tolist(), "size": [200, 160]}]})
        np.testing.assert_allclose(calibrated.P[0], RING.P[3], atol=1e-9)
        assert (calibrated.names, calibrated.sizes, calibrated.unit) == (("cam_00",), ((160, 200),), None)


def test_npz_of_a_synthetic_sequence_is_read(tmp_path):
    np.savez(tmp_path / "cameras.npz", P=RING.P, size=RING.size)
    calibrated = read_calibration(calibration_files(tmp_path))
    np.testing.assert_array_equal(calibrated.P, RING.P)
    assert calibrated.names == tuple(NAMES)
    assert set(calibrated.sizes) == {(160, 200)}


def test_opencv_yaml_in_two_files_is_read(tmp_path):
    intri, extri = "%YAML:1.0\n---\nnames:\n   - a\n   - b\n", "%YAML:1.0\n---\n"
    for c, name in enumerate("ab"):
        K, R, t = parted(RING.P[c])
        intri += f"K_{name}: {matrix(K)}dist_{name}: {matrix(np.zeros(5))}H_{name}: 160\nW_{name}: 200\n"
        extri += f"Rot_{name}: {matrix(R)}T_{name}: {matrix(t[:, None])}"
    (tmp_path / "intri.yml").write_text(intri)
    (tmp_path / "extri.yml").write_text(extri)
    calibrated = read_calibration(calibration_files(tmp_path))
    assert (calibrated.names, calibrated.sizes) == (("a", "b"), ((160, 200), (160, 200)))
    np.testing.assert_allclose(calibrated.P, RING.P[:2], atol=1e-9)


def test_folder_without_calibration_has_none(tmp_path):
    assert calibration_files(tmp_path) == []


EYE = np.eye(3).tolist()


@pytest.mark.parametrize(
    ("camera", "words"),
    [
        ({"name": "left", "K": EYE, "R": EYE}, "camera left: no t; either P"),
        ({"name": "left", "P": EYE}, r"camera left: P has shape \(3, 3\), finite numbers \(3, 4\)"),
        ({"P": np.zeros((3, 4)).tolist()}, "camera cam_00: the left 3 × 3 of P is singular"),
        ({"K": EYE, "R": (2 * np.eye(3)).tolist(), "t": [0, 0, 0]}, "camera cam_00: R is no rotation"),
        ({"K": EYE, "R": EYE, "t": [0, 0, float("nan")]}, "camera cam_00: t has shape"),
        ({"P": RING.P[0].tolist(), "distortion": [0.1, 0, 0, 0]}, "lens distortion .* is not applied; undistort the masks"),
    ],
)
def test_camera_that_cannot_be_is_named(read, camera, words):
    with pytest.raises(SourceError, match=words):
        read({"cameras": [camera]})


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        ("{}", "calibration.json", 'no list "cameras"'),
        ("[", "calibration.json", "not JSON"),
        ("%YAML:1.0\n---\na: 1\n", "calibration.yml", "no nodes K_name or P_name"),
        ("!!python/object/apply:os.system ['true']", "calibration.yml", "could not determine a constructor"),
        ("PK", "cameras.npz", "cannot be read as a calibration"),
    ],
)
def test_file_that_is_no_calibration_is_refused(read, text, name, words):
    with pytest.raises(SourceError, match=words):
        read(text, name)


def test_pickled_matrices_and_other_shapes_are_refused(tmp_path):
    np.savez(tmp_path / "cameras.npz", P=np.array([{}], dtype=object))
    with pytest.raises(SourceError, match="cannot be read"):
        read_calibration(calibration_files(tmp_path))
    np.savez(tmp_path / "cameras.npz", P=np.eye(3))
    with pytest.raises(SourceError, match=r"P is \(3, 3\); \(camera, 3, 4\)"):
        read_calibration(calibration_files(tmp_path))


def test_two_cameras_of_one_name_are_refused(read):
    with pytest.raises(SourceError, match="two cameras have one name"):
        read({"cameras": [{"name": "a", "P": RING.P[0].tolist()}, {"name": "a", "P": RING.P[1].tolist()}]})
