"""skeleton.trc, read back line by line as OpenSim's documentation describes it."""

import numpy as np
from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.pipeline import views
from kinetree.schemas.results.trc import TrcParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.trc import trc

Z_UP = UpDirection(up="z", confidence=0.9)


def lines(skeleton, **params):
    text = views.files(trc(skeleton, plain(skeleton), Z_UP, TrcParams(**params)), ())["skeleton.trc"].decode()
    return [line.split("\t") for line in text.split("\n")]


def test_head_says_rate_counts_and_unit():
    head = dict(zip(*lines(spider())[1:3], strict=True))
    assert head == {
        "DataRate": "10", "CameraRate": "10", "NumFrames": "12", "NumMarkers": "7", "Units": "mm", "OrigDataRate": "10",
        "OrigDataStartFrame": "1", "OrigNumFrames": "12",
    }  # fmt: skip


def test_every_joint_is_a_marker_upright_along_y_in_millimetres():
    body = spider(unit="cm")
    content = lines(body)
    assert content[3][2::3][:7] == list(body.names)
    assert content[4][2:5] == ["X1", "Y1", "Z1"]
    assert content[5] == [""]
    rows = np.array(content[6:-1], dtype=float)
    np.testing.assert_array_equal(rows[:, 0], np.arange(1, 13))
    np.testing.assert_allclose(rows[:, 1], np.arange(12) / 10)
    expected = 10 * body.positions[..., [0, 2, 1]] * [1, 1, -1]
    np.testing.assert_allclose(rows[:, 2:].reshape(12, 7, 3), expected, atol=1e-5)
    assert np.array(lines(body, up="z", scale=1.0)[6:-1], dtype=float)[2, 4] == np.round(body.positions[2, 0, 2], 6)


def test_frame_that_is_missing_is_empty_and_keeps_its_time():
    content = lines(spider(frames=(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 26)))[6:-1]
    assert len(content) == 14
    assert [not any(row[2:]) for row in content] == [False] * 11 + [True, True, False]
    assert content[13][1] == "2.600000"
