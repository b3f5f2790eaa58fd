"""A BVH file whose positions are known, and damaged ones."""

import numpy as np
import pytest

from kinetree.errors import InputError
from kinetree.tasks.numerics.results.bvh_reader import read_bvh

ARM = """HIERARCHY
ROOT hips
{
  OFFSET 1 2 3
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT knee
  {
    OFFSET 0 -2 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 -1 0
    }
  }
  JOINT arm
  {
    OFFSET 1 0 0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {
      OFFSET 1 0 0.5
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
10 20 30 10 20 30 40 50 60 5 15 25
11 21 31 0 0 0 90 0 0 0 0 0
"""


def test_hierarchy_is_read_in_its_order():
    clip = read_bvh(ARM, "arm.bvh")
    assert clip.names == ("hips", "knee", "knee end", "arm", "arm end")
    assert clip.parents == (-1, 0, 1, 0, 3)
    assert clip.is_end_site == (False, False, True, False, True)
    assert clip.frame_time == 0.04


def test_positions_equal_those_of_another_program():
    """From pybvh 0.9.0: read_bvh_file("arm.bvh").node_positions()."""
    clip = read_bvh(ARM, "arm.bvh")
    expected = [
        [[10, 20, 30], [10.3264, 18.1492, 29.3160], [10.3302, 17.9821, 28.3300], [10.8232, 20.3188, 29.5302],
         [11.8413, 20.7764, 29.5930]],
        [[11, 21, 31], [11, 19, 31], [12, 19, 31], [12, 21, 31], [13, 21, 31.5]],
    ]  # fmt: skip
    assert np.allclose(clip.X, expected, rtol=0, atol=6e-5)


def test_position_channels_of_a_joint_stand_in_place_of_its_offset():
    text = ARM.replace("OFFSET 1 0 0\n    CHANNELS 3", "OFFSET 7 8 9\n    CHANNELS 6 Xposition Yposition Zposition")
    text = text.replace("5 15 25", "1 0 0 5 15 25").replace("90 0 0 0 0 0", "90 0 0 1 0 0 0 0 0")
    six, three = read_bvh(text, "arm.bvh"), read_bvh(ARM, "arm.bvh")
    assert np.allclose(six.X, three.X)


def test_rotations_are_against_the_parent_in_the_order_of_the_channels():
    R = read_bvh(ARM, "arm.bvh").R
    assert R[1, 1] == pytest.approx(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), abs=1e-12)
    assert np.linalg.det(R) == pytest.approx(np.ones((2, 5)))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("HIERARCHY", "ply", "line 1: expected HIERARCHY, got 'ply'; it is not a BVH"),
        ("ROOT hips", "JOINT hips", "line 2: expected ROOT"),
        ("OFFSET 1 2 3", "OFFSET 1 2", "line 5: expected a number, got 'CHANNELS'"),
        ("OFFSET 1 2 3", "OFFSET 1 2 nan", "line 4: nan is not a finite number"),
        ("OFFSET 1 2 3", "OFFSET 1 2 1e300", "line 4: 1e300 is larger than 1e+50"),
        ("Zrotation Xrotation Yrotation\n  JOINT", "Zrotation Zrotation Yrotation\n  JOINT", "line 5: channel 'Zrotation'"),
        ("Xposition Y", "Xpos Y", "line 5: channel 'Xpos'; expected each of Xposition"),
        ("Frames: 2", "Frames: 3", "line 28: 3 frames of 12 channels are 36 numbers, but 24 follow"),
        ("Frames: 2", "Frames: 0", "0 frames of 0.04 seconds"),
        (" 25\n", " 25 1\n", "24 numbers, but 25 follow"),
        ("40 50", "40 fifty", "line 28: expected a number, got 'fifty'"),
        ("MOTION", "ROOT hips", "line 25: a second ROOT"),
        ("\nMOTION", "\n", "expected MOTION, got 'Frames:'"),
    ],
)
def test_broken_file_is_refused_with_its_line(old, new, message):
    with pytest.raises(InputError) as refused:
        read_bvh(ARM.replace(old, new, 1), "arm.bvh")
    assert message in str(refused.value)
    assert str(refused.value).startswith("arm.bvh, line ")


@pytest.mark.parametrize("length", [0, 9, 60, 200, 450])
def test_file_that_is_cut_off_is_refused(length):
    with pytest.raises(InputError, match=r"arm\.bvh, line"):
        read_bvh(ARM[:length], "arm.bvh")


def test_hierarchy_without_channels_or_without_end_is_refused():
    head = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n"
    nested = "JOINT b\n{\nOFFSET 0 1 0\n" * 5000
    for below, message in (("", "no joint has a channel"), (nested, "joints are nested too deep")):
        with pytest.raises(InputError, match=message):
            read_bvh(f"{head}{below}}}\nMOTION\nFrames: 2000000000\nFrame Time: 0.1\n", "a.bvh")
