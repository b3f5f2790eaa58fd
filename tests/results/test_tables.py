"""The CSV tables."""

import csv
import io
import json
from itertools import pairwise

import numpy as np
import pytest
from results.plain_names import plain
from results.rigged_bodies import bars_of, spider
from results.true_skeletons import generated, perfect
from scipy.signal import savgol_filter
from scipy.spatial.transform import Rotation

from kinetree.errors import ConfigError
from kinetree.pipeline import views
from kinetree.schemas.results.tables import TablesParams
from kinetree.schemas.structure.joint_names import JointNamesParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.axial_rotation import BENT
from kinetree.tasks.results.formats import tables as format_of_tables
from kinetree.tasks.results.formats.tables import bone_angles
from kinetree.tasks.results.tables import tables
from kinetree.tasks.structure.error_bars import unknown_error_bars
from kinetree.tasks.structure.joint_names import joint_names

UP = UpDirection(up="z", confidence=1.0)


@pytest.fixture
def body():
    return spider()


def files(skeleton, **params):
    return views.files(tables(skeleton, plain(skeleton), UP, unknown_error_bars(skeleton), TablesParams(**params)), ())


def rows(skeleton, name, **params):
    return list(csv.reader(io.StringIO(files(skeleton, **params)[f"tables/{name}.csv"].decode(), newline="")))


def test_trajectories_are_a_row_a_frame_with_its_time(body):
    head, *values = rows(body, "positions")
    assert head[:5] == ["frame", "seconds", "trunk.x", "trunk.y", "trunk.z"]
    numbers = np.array(values, dtype=float)
    np.testing.assert_array_equal(numbers[:, 0], body.frames)
    np.testing.assert_allclose(numbers[:, 1], np.arange(12) / 10)
    np.testing.assert_allclose(numbers[:, 2:].reshape(body.positions.shape), body.positions, rtol=1e-8, atol=1e-7)


def test_motion_has_a_row_for_every_joint_in_every_frame(body):
    head, *values = rows(body, "motion")
    assert head == [
        "frame", "seconds", "joint", "x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az", "qx", "qy", "qz", "qw", "confidence",
    ]  # fmt: skip
    assert [row[2] for row in values] == list(body.names) * 12
    numbers = np.array([[row[0], row[1], *row[3:]] for row in values], dtype=float).reshape(12, 7, 16)
    np.testing.assert_allclose(numbers[..., 2:5], body.positions, rtol=1e-8, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(numbers[..., 11:15], axis=-1), 1.0, atol=1e-8)
    velocity = savgol_filter(body.positions, 5, 3, deriv=1, delta=0.1, axis=0)
    np.testing.assert_allclose(numbers[..., 5:8], velocity, rtol=1e-7, atol=1e-6)
    acceleration = savgol_filter(body.positions, 5, 3, deriv=2, delta=0.1, axis=0)
    np.testing.assert_allclose(numbers[..., 8:11], acceleration, rtol=1e-7, atol=1e-5)


def test_text_of_strangers_is_no_formula_of_a_spreadsheet(body):
    of_stranger = body.model_copy(update={"unit": '=HYPERLINK("http://x")', "names": ("@root", *body.names[1:])})
    assert {row[-1] for row in rows(of_stranger, "joints")[1:]} == {'\'=HYPERLINK("http://x")'}
    assert rows(of_stranger, "confidence")[0][2] == "'@root"
    assert rows(of_stranger, "motion")[1][2] == "'@root"
    assert min(float(row[3]) for row in rows(of_stranger, "motion")[1:]) < 0, "numbers stay numbers"


def test_smoothing_is_said():
    assert views.remarks(
        tables(spider(), plain(spider()), UP, unknown_error_bars(spider()), TablesParams(window=0.7, degree=2))
    ) == ("velocities and accelerations: Savitzky-Golay over 7 frames (0.7 s), polynomials of degree 2",)
    (remark,) = views.remarks(
        tables(spider(fps=None), plain(spider(fps=None)), UP, unknown_error_bars(spider()), TablesParams())
    )
    assert "no velocities" in remark
    assert {row[6] for row in rows(spider(fps=None), "motion")[1:]} == {""}


def test_joints_are_told_with_parent_and_range(body):
    head, *values = rows(body, "joints")
    assert head == ["joint", "parent", "kind", "length", "range", "unit"]
    assert values[2][:3] == ["hand", "arm", "leaf"]
    assert [float(row[4]) for row in values] == pytest.approx(body.degrees.tolist())


def test_parquet_holds_the_same_tables(body):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pip install pyarrow brings the reader")
    written = files(body, form="parquet")
    assert set(written) == {name.replace(".csv", ".parquet") for name in files(body)}
    table = parquet.read_table(io.BytesIO(written["tables/motion.parquet"])).to_pydict()
    assert list(table) == rows(body, "motion")[0]
    np.testing.assert_array_equal(np.reshape(table["y"], (12, 7)), body.positions[..., 1])
    unknown = parquet.read_table(io.BytesIO(files(spider(fps=None), form="parquet")["tables/motion.parquet"]))
    assert unknown["vx"].null_count == len(unknown)
    assert written == files(body, form="parquet")


def test_missing_package_says_which_extra_brings_it(monkeypatch):
    def absent(name):
        raise ImportError(name)

    monkeypatch.setattr(format_of_tables, "import_module", absent)
    with pytest.raises(ConfigError, match=r"pip install 'kinetree\[parquet\]'"):
        files(spider(), form="parquet")


def test_time_is_empty_where_nobody_knows_it():
    assert {row[1] for row in rows(spider(fps=None), "angles")[1:]} == {""}


def test_confidence_is_told_of_every_joint(body):
    head, *values = rows(body, "confidence")
    assert head[2:] == list(body.names)
    assert {value for row in values for value in row[2:]} == {"0.75"}


def test_bones_have_their_length_and_unit(body):
    head, *values = rows(body, "bones")
    assert head == ["parent", "child", "length", "unit"]
    assert values[0] == ["trunk", "arm", "4", "mm"]
    assert len(values) == 6


def test_angle_is_180_in_line_90_at_a_right_angle_and_0_folded(body):
    X = np.zeros((4, 7, 3))
    X[:, 1] = [1, 0, 0]
    X[:, 2] = [[2, 0, 0], [1, 1, 0], [0.5, 0, 0], [1, 0, -3]]
    X[:, 4:] = np.eye(3)
    few = {"rotation": body.rotation[:4], "confidence": body.confidence[:4], "frames": (0, 1, 2, 3)}
    pairs, angles = bone_angles(spider(positions=X, **few))
    assert pairs == [(0, 1, 2), (0, 4, 5), (0, 4, 6)]
    np.testing.assert_allclose(angles[:, 0], [180, 90, 0, 90], atol=1e-9)


def test_angles_are_named_by_their_three_joints(body):
    assert rows(body, "angles")[0][2:] == ["trunk/arm/hand", "trunk/knee/foot", "trunk/knee/spur"]


def test_names_with_commas_quotes_and_line_ends_stay_one_cell():
    names = ("a,b", 'c"d', "e\nf", "é", "<script>", " ", "g;h")
    assert rows(spider(names=names), "confidence")[0][2:] == list(names)


@pytest.fixture(scope="module")
def walker():
    """A generated person that walks on the spot at 0.8 strides a second, and its names."""
    body = perfect(generated(frames=100, motion="walk"))
    return body, joint_names(body, UP, JointNamesParams())


def table(walker, name):
    body, names = walker
    written = views.files(tables(body, names, UP, unknown_error_bars(body), TablesParams()), ())[f"tables/{name}.csv"].decode()
    return list(csv.DictReader(io.StringIO(written, newline="")))


@pytest.mark.parametrize(("side", "amplitude"), [("l", 26.0), ("r", -26.0)])
def test_hip_of_a_walker_flexes_as_it_was_made_to(walker, side, amplitude):
    found = np.array([float(row[f"hip_{side}.flexion"]) for row in table(walker, "joint_angles")])
    made = amplitude * np.sin(2 * np.pi * 0.8 * np.arange(100) / 25)  # about −x, which is the right of who faces −y
    np.testing.assert_allclose(found - found.mean(), made - made.mean(), atol=1.5)
    assert found.mean() == pytest.approx(8.0, abs=3.0)


def test_knees_of_a_walker_only_bend_backwards(walker):
    for side in "lr":
        knee = np.array([float(row[f"knee_{side}.flexion"]) for row in table(walker, "joint_angles")])
        assert knee.min() > -2.0
        assert knee.max() > 50.0


def angles_if_shown(walker, joint, known):
    """The rows of the joint angles if one joint is known by this, and all others by motion."""
    body, names = walker
    evidence = tuple(known if name == joint else "motion" for name in names.anatomy)
    bars = unknown_error_bars(body).model_copy(update={"evidence": evidence})
    written = views.files(tables(body, names, UP, bars, TablesParams()), ())["tables/joint_angles.csv"].decode()
    return list(csv.DictReader(io.StringIO(written, newline="")))


@pytest.mark.parametrize("known", ["mirror", "narrowing"])
def test_a_joint_that_the_other_side_or_a_narrowing_alone_shows_has_no_angles(walker, known):
    """They would be those of the reference pose in every frame."""
    before, after = (list(rows[0]) for rows in (table(walker, "joint_angles"), angles_if_shown(walker, "hip_l", known)))
    assert "hip_l.rotation_seen" in before
    assert after == [column for column in before if not column.startswith("hip_l.")]


@pytest.mark.parametrize("known", ["mirror", "narrowing"])
def test_a_wrist_at_which_no_turn_was_measured_shows_no_pronation(walker, known):
    rows = angles_if_shown(walker, "wrist_l", known)
    assert {row["elbow_l.rotation_seen"] for row in rows} == {"0"}
    assert {row["elbow_r.rotation_seen"] for row in rows} == {"1"}
    assert {row["elbow_l.rotation_seen"] for row in table(walker, "joint_angles")} == {"1"}


def test_frames_in_which_a_knee_is_bent_show_how_the_thigh_is_turned(walker):
    rows = table(walker, "joint_angles")
    for side in "lr":
        bent = np.array([float(row[f"knee_{side}.flexion"]) for row in rows]) >= BENT
        seen = np.array([row[f"hip_{side}.rotation_seen"] for row in rows])
        assert set(seen) == {"0", "1"}
        np.testing.assert_array_equal(seen == "1", bent)
    assert not [name for name in rows[0] if name.startswith("ankle") and name.endswith("rotation_seen")]


def test_steps_of_a_walker_alternate_and_last_as_long_as_they_were_made_to(walker):
    body, names = walker
    told = json.loads(views.files(tables(body, names, UP, unknown_error_bars(body), TablesParams()), ())["tables/gait.json"])
    for foot in ("foot_l", "foot_r"):
        assert told["feet"][foot]["stride_seconds"] == pytest.approx(1.25, abs=0.04)
    assert abs(told["symmetry"]["foot"]["stride_percent"]) < 5
    strikes = [(row["foot"], float(row["seconds"])) for row in table(walker, "gait") if row["event"] == "strike"]
    feet, seconds = zip(*strikes, strict=True)
    assert len(strikes) >= 3
    assert all(a != b for a, b in pairwise(feet))
    np.testing.assert_allclose(np.diff(seconds), 1.25 / 2, atol=0.1)


def test_body_that_is_not_recognised_or_faces_nobody_knows_where_has_no_anatomical_tables(walker):
    body, names = walker
    for unsure in (plain(body), names.model_copy(update={"front_confidence": 0.2})):
        held = views.files(tables(body, unsure, UP, unknown_error_bars(body), TablesParams()), ())
        assert not {"tables/joint_angles.csv", "tables/gait.csv", "tables/gait.json"} & set(held)
        assert "tables/turns.csv" in held


def test_turns_of_every_joint_are_those_of_the_rig_and_zero_at_rest(body):
    still = spider(rotation=np.tile(np.eye(3), (12, 7, 1, 1)))
    head, *values = rows(still, "turns")
    assert head == ["frame", "seconds", *(f"{n}.{a}" for n in ("arm", "knee") for a in ("swing_x", "twist", "swing_z"))]
    np.testing.assert_allclose(np.array(values, float)[:, 2:], 0.0, atol=1e-9)
    moved = np.array(rows(body, "turns")[1:], float)[:, 2:5]
    relative = body.rotation[:, 0].transpose(0, 2, 1) @ body.rotation[:, 1]
    whole = Rotation.from_rotvec(np.radians(moved * (1, 0, 1))) * Rotation.from_rotvec(np.radians(moved * (0, 1, 0)))
    np.testing.assert_allclose(whole.magnitude(), Rotation.from_matrix(relative).magnitude(), atol=1e-6)


def test_joints_have_their_expected_error_and_its_evidence_and_frames_have_theirs(body):
    bars = bars_of(body)
    made = views.files(tables(body, plain(body), UP, bars, TablesParams()), ())
    head, *values = csv.reader(io.StringIO(made["tables/joints.csv"].decode(), newline=""))
    for row, kind, expected in zip(values, body.kinds, bars.expected, strict=True):
        told = dict(zip(head, row, strict=True))
        if kind == "joint":
            assert float(told["expected_error"]) == pytest.approx(expected)
            assert float(told["error_bound"]) == pytest.approx(2 * expected)
            assert float(told["asymmetry"]) == pytest.approx(0.4 * expected)
            assert (told["cuts_agreeing"], told["cuts"], told["frames_seen"], told["evidence"]) == ("3", "4", "12", "motion")
        else:
            assert told["expected_error"] == told["cuts"] == told["frames_seen"] == told["evidence"] == ""
    head, *values = csv.reader(io.StringIO(made["tables/errors.csv"].decode(), newline=""))
    j = body.kinds.index("joint")
    assert head[2:] == list(body.names)
    assert [float(row[2 + j]) for row in values] == pytest.approx(bars.in_frame[:, j])
    assert "tables/errors.csv" not in files(body)
