"""Laws of numbering: a frame has the number of its name, gaps stay gaps, and two bodies are not one sequence."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input.frame_numbers import TAKE, are_frame_numbers, frame_numbers, selected_frames, take_spans


def numbers(*names):
    return frame_numbers([Path("scans") / name for name in names])


@given(st.sets(st.integers(0, 10**9 - 1), min_size=2), st.integers(0, 9))
def test_number_of_a_frame_is_the_one_in_its_name(found, width):
    assert numbers(*(f"take_3_{n:0{width}d}.ply" for n in sorted(found))) == sorted(found)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (("frame_0000.ply", "frame_0001.ply", "frame_0003.ply"), [0, 1, 3]),
        (("f1.ply", "F2.ply", "f4.PLY"), [1, 2, 4]),
        (("frame_7/mesh.ply", "frame_9/mesh.ply"), [7, 9]),
        (("2_at_10.5.ply", "3_at_10.9.ply", "5_at_10.1.ply"), [2, 3, 5]),
        (("a.ply", "b.ply", "c.ply"), [0, 1, 2]),
        (("1999-01-01T10.ply",), [0]),
        (("t_10_900000000.ply", "t_11_100000000.ply", "t_11_500000000.ply"), [0, 1, 2]),
        (("1699999999123.ply", "1699999999163.ply"), [0, 1]),
        (("take_1/f_1.ply", "take_1/f_2.ply", "take_2/f_1.ply"), [0, 1, 2]),
    ],
)
def test_numbers_of_names(names, expected):
    assert numbers(*names) == expected


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (
            ("run_0001.ply", "run_0002.ply", "walk_0001.ply"),
            r"scans/run_0001\.ply and scans/walk_0001\.ply: names of several series \(2 × run_#, 1 × walk_#\).*run_\*\.ply",
        ),
        (("frame_1.ply", "frame_2.ply", "reference.ply"), r"frame_1\.ply and scans/reference\.ply: names of several series"),
        (("f_2.ply", "f_2_clean.ply", "f_3.ply"), r"f_2\.ply and scans/f_2_clean\.ply: names of several series"),
        (("walk1_1.ply", "walk1_2.ply", "walk2_1.ply"), r"walk1_1\.ply and scans/walk2_1\.ply: two files have the same number"),
        (("f_1.ply", "f_01.ply"), r"f_1\.ply and scans/f_01\.ply: two files have the same number"),
        (("f_1.ply", "f_01.ply", "f_2.ply"), r"f_1\.ply and scans/f_01\.ply: two files have the same number"),
    ],
)
def test_several_series_are_refused_by_their_files(names, words):
    with pytest.raises(SourceError, match=words):
        numbers(*names)


@pytest.mark.parametrize(
    ("text", "chosen"),
    [
        (":", [1, 2, 3, 5, 6]),
        ("2:6", [2, 3, 5]),
        ("::2", [1, 3, 5]),
        ("-2:", [5, 6]),
        (":-2", [1, 2, 3]),
        ("-99:3", [1, 2]),
        ("4:999", [5, 6]),
    ],
)
def test_range_is_over_the_numbers_of_the_frames(text, chosen):
    assert selected_frames(text, [1, 2, 3, 5, 6], "scans") == chosen


@given(st.integers(1, 30), st.integers(-40, 40) | st.none(), st.integers(-40, 40) | st.none(), st.integers(1, 7) | st.none())
def test_frames_from_zero_without_gaps_are_selected_as_by_a_slice(count, start, stop, step):
    text = ":".join("" if n is None else str(n) for n in (start, stop, step))
    expected = list(range(count))[start:stop:step]
    if expected:
        assert selected_frames(text, range(count), "scans") == expected
    else:
        with pytest.raises(SourceError, match=f"selects none of the {count} frames of scans$"):
            selected_frames(text, range(count), "scans")


def test_refusal_says_how_the_frames_are_numbered():
    with pytest.raises(SourceError, match=r"^frames '20:' selects none of the 3 frames of scans, numbered 1 to 4$"):
        selected_frames("20:", [1, 2, 4], "scans")


def test_longer_numbers_are_no_frame_numbers():
    assert are_frame_numbers([0, 999_999_999])
    assert not are_frame_numbers([0, 1_000_000_000])


def test_numbers_alone_say_where_a_take_begins():
    assert take_spans([3, 4, 9]) == [slice(0, 3)]
    assert take_spans([TAKE - 1, TAKE, TAKE + 5, 3 * TAKE + 1]) == [slice(0, 1), slice(1, 3), slice(3, 4)]
