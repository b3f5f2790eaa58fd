"""The CSV tables."""

import csv
import io

import numpy as np
import pytest
from results.plain_names import plain
from results.rigged_bodies import spider
from scipy.signal import savgol_filter

from kinetree.errors import ConfigError
from kinetree.pipeline import views
from kinetree.schemas.results.tables import TablesParams
from kinetree.tasks.results.formats import tables as format_of_tables
from kinetree.tasks.results.formats.tables import bone_angles
from kinetree.tasks.results.tables import tables


@pytest.fixture
def body():
    return spider()


def files(skeleton, **params):
    return views.files(tables(skeleton, plain(skeleton), TablesParams(**params)), ())


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
    assert views.remarks(tables(spider(), plain(spider()), TablesParams(window=0.7, degree=2))) == (
        "velocities and accelerations: Savitzky-Golay over 7 frames (0.7 s), polynomials of degree 2",
    )
    (remark,) = views.remarks(tables(spider(fps=None), plain(spider(fps=None)), TablesParams()))
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
